// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/build_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <opencv2/core.hpp>
#include <random>
#include <sstream>
#include <thread>
#include <tuple>

#include "mapbuilder/batch/journal_bytes.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

std::string Key(int i) {
  std::string key(64, 'a');
  for (std::size_t digit = 63; i > 0; i /= 10) {
    key[digit--] = static_cast<char>('0' + i % 10);
  }
  return key;
}

Bytes Piece(int i) { return Bytes(static_cast<std::size_t>(100 * i), static_cast<std::uint8_t>(i)); }

class BuildJournalTest : public ::testing::Test {
 protected:
  void Write(int count) {
    BuildJournal journal(file_, false, &warnings_);
    for (int i = 0; i < count; ++i) {
      journal.Put(Key(i), Piece(i));
    }
    journal.Flush();
  }
  // Number of the first `count` entries that exist; each must be unchanged or missing.
  int CountIntact(BuildJournal* journal, int count) const {
    int whole = 0;
    for (int i = 0; i < count; ++i) {
      if (const auto piece = journal->Get(Key(i))) {
        EXPECT_EQ(*piece, Piece(i)) << i;
        ++whole;
      }
    }
    return whole;
  }
  int Resume(int count) {
    BuildJournal journal(file_, true, &warnings_);
    return CountIntact(&journal, count);
  }
  std::string Read() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void Overwrite(const std::string& content) const { std::ofstream(file_, std::ios::binary) << content; }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap.journal";
  std::ostringstream warnings_;
};

TEST_F(BuildJournalTest, WhatWasPutIsThereForTheNextRun) {
  Write(20);
  EXPECT_EQ(Resume(20), 20);
  EXPECT_EQ(Resume(20), 20) << "reading must not change it";
  BuildJournal journal(file_, true, &warnings_);
  EXPECT_FALSE(journal.Get(Key(20)));
  journal.Put(Key(20), Piece(20));
  journal.Flush();
  EXPECT_EQ(warnings_.str(), "");
}

TEST_F(BuildJournalTest, AResumedRunAddsToIt) {
  Write(5);
  {
    BuildJournal journal(file_, true, &warnings_);
    journal.Put(Key(5), Piece(5));
  }
  EXPECT_EQ(Resume(6), 6);
}

TEST_F(BuildJournalTest, WithoutResumeItStartsEmpty) {
  Write(5);
  { BuildJournal journal(file_, false, &warnings_); }
  EXPECT_EQ(Resume(5), 0);
}

TEST_F(BuildJournalTest, NothingIsLeftOfABuildThatIsDoneOrHardlyBegan) {
  { BuildJournal journal(file_, false, &warnings_); }
  EXPECT_FALSE(std::filesystem::exists(file_));
  Write(5);
  EXPECT_TRUE(std::filesystem::exists(file_));
  BuildJournal journal(file_, true, &warnings_);
  journal.Remove();
  EXPECT_FALSE(std::filesystem::exists(file_));
  journal.Put(Key(1), Piece(1));
  journal.Flush();
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(BuildJournalTest, CutOffAnywhereTheRestIsUsed) {
  Write(10);
  const std::string whole = Read();
  int most = 0;
  for (std::size_t size = 0; size <= whole.size(); size += 37) {
    Overwrite(whole.substr(0, size));
    const int found = Resume(10);
    EXPECT_GE(found, most);
    most = found;
  }
  EXPECT_GE(most, 9);
}

TEST_F(BuildJournalTest, WhateverIsOverwrittenNothingWrongIsRead) {
  Write(10);
  const std::string whole = Read();
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = whole;
    const std::size_t at = random() % damaged.size();
    const std::size_t count = std::min<std::size_t>(1 + random() % 200, damaged.size() - at);
    for (std::size_t i = at; i < at + count; ++i) {
      damaged[i] = static_cast<char>(random());
    }
    Overwrite(damaged);
    EXPECT_LE(Resume(10), 10);  // CountIntact compares the entries
  }
  EXPECT_THAT(warnings_.str(), HasSubstr("is damaged"));
}

TEST_F(BuildJournalTest, AnotherFileIsReplacedWithAWarning) {
  Overwrite("timestamp,filename\n1,images/000000.jpg\n");
  EXPECT_EQ(Resume(5), 0);
  EXPECT_THAT(warnings_.str(), HasSubstr("m.floormap.journal is damaged or not a journal"));
}

TEST_F(BuildJournalTest, TwoBuildsDoNotShareOne) {
  BuildJournal first(file_, false, &warnings_);
  BuildJournal second(file_, false, &warnings_);
  EXPECT_THAT(warnings_.str(), HasSubstr("in use by another build"));
  second.Put(Key(1), Piece(1));
  second.Flush();
  second.Remove();
  EXPECT_TRUE(std::filesystem::exists(file_));
  first.Put(Key(2), Piece(2));
  first.Flush();
  EXPECT_FALSE(second.Get(Key(2)));
}

TEST_F(BuildJournalTest, AFolderThatIsMissingIsAWarning) {
  BuildJournal journal(folder_.path() / "missing" / "m.journal", true, &warnings_);
  journal.Put(Key(1), Piece(1));
  journal.Flush();
  EXPECT_FALSE(journal.Get(Key(1)));
  EXPECT_THAT(warnings_.str(), HasSubstr("cannot be opened"));
}

TEST_F(BuildJournalTest, AFullDiskStopsTheJournalOnly) {
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  {
    BuildJournal journal(file_, false, &warnings_);
    journal.Put(Key(9), Piece(9));
    journal.Flush();
    const rlimit full{2000, old.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    for (int i = 10; i < 40; ++i) {
      journal.Put(Key(i), Piece(i));
      journal.Flush();
    }
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(warnings_.str(), HasSubstr("cannot be written any more"));
  warnings_.str("");
  EXPECT_EQ(Resume(40), 1);
  EXPECT_EQ(warnings_.str(), "");
}

TEST_F(BuildJournalTest, ManyThreadsMayPut) {
  {
    BuildJournal journal(file_, false, &warnings_);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&journal, t] {
        for (int i = t; i < 100; i += 4) {
          journal.Put(Key(i), Piece(i));
          if (i % 7 == 0) {
            journal.Flush();
          }
        }
      });
    }
  }
  EXPECT_EQ(Resume(100), 100);
}

TEST(JournalBytesTest, ValuesComeBack) {
  cv::Mat image(3, 5, CV_32F);
  cv::randu(image, 0.0, 1.0);
  const Bytes bytes = ByteWriter()
                          .Add(7)
                          .Add(std::string("seven"))
                          .Add(std::vector<double>{1.5, -2.5})
                          .Add(cv::Mat(image.colRange(1, 4)))
                          .Take();
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ByteReader reader(part);
    int number = 0;
    std::string text;
    std::vector<double> numbers;
    cv::Mat mat;
    reader.Read(&number);
    reader.Read(&text);
    reader.Read(&numbers);
    reader.Read(&mat);
    EXPECT_EQ(reader.Complete(), size == bytes.size());
    if (reader.Complete()) {
      EXPECT_EQ(number, 7);
      EXPECT_EQ(text, "seven");
      EXPECT_EQ(numbers, (std::vector<double>{1.5, -2.5}));
      EXPECT_EQ(cv::norm(mat, image.colRange(1, 4), cv::NORM_INF), 0.0);
    }
  }
}

TEST(JournalBytesTest, AMatrixWhoseSizeWrapsAroundIsRefused) {
  const Bytes no_pixels;
  // 2^30 x 2^30 cells of 16 bytes are 2^64 bytes, which overflows to 0.
  const Bytes bytes = ByteWriter().Add(1 << 30).Add(1 << 30).Add(CV_32FC4).Add(no_pixels).Take();
  ByteReader reader(bytes);
  cv::Mat mat;
  reader.Read(&mat);
  EXPECT_TRUE(reader.failed());
  EXPECT_TRUE(mat.empty());
}

TEST(JournalBytesTest, NegativeSizesAndStrangeTypesAreRefused) {
  for (const auto& [rows, cols, type] : {std::tuple{-1, 0, CV_8U}, {0, -1, CV_8U}, {0, 0, 1 << 20}, {0, 0, -1}}) {
    const Bytes bytes = ByteWriter().Add(rows).Add(cols).Add(type).Add(Bytes()).Take();
    ByteReader reader(bytes);
    cv::Mat mat;
    reader.Read(&mat);
    EXPECT_TRUE(reader.failed()) << rows << " " << cols << " " << type;
  }
}

TEST(JournalBytesTest, OnlyZeroAndOneAreTruthValues) {
  for (const int byte : {0, 1, 2, 255}) {
    const Bytes bytes = {static_cast<std::uint8_t>(byte)};
    ByteReader reader(bytes);
    bool value = false;
    reader.Read(&value);
    EXPECT_EQ(reader.Complete(), byte <= 1) << byte;
    EXPECT_EQ(value, byte == 1) << byte;
  }
}

}  // namespace
}  // namespace floorloc
