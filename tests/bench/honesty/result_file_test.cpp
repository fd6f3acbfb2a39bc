// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/honesty/result_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <optional>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "tests/bench/scenes/frame_runner.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

FrameRecord MakeRecord(int frame) {
  FrameRecord record{frame, FramePlace::kEdge, "hard", 12.5, {}};
  record.fixes.push_back({SearchKind::kGlobal, LocalizationStatus::kLocalized, true, 1.0 / 3.0e9, 4e-4, 1e-3, 2.7, 120,
                          0.875, false, 8.25});
  record.fixes.push_back({SearchKind::kWrongPrior, LocalizationStatus::kAmbiguous, true, 0.5, kInfinity, kInfinity,
                          kInfinity, 9, std::nullopt, true, 3.5});
  return record;
}

class ResultFileTest : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "floor.jsonl"; }
  void Append(const std::string& text) const { std::ofstream(file(), std::ios::app) << text; }
  void WriteThree() const { ResultFile(file(), "title").Append({MakeRecord(0), MakeRecord(1), MakeRecord(2)}); }

 private:
  TemporaryFolder folder_;
};

TEST_F(ResultFileTest, GivesBackWhatWasWritten) {
  WriteThree();
  const ResultFile reopened(file(), "title");
  ASSERT_EQ(reopened.records().size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const FrameRecord& record = reopened.records()[static_cast<std::size_t>(i)];
    EXPECT_TRUE(SameAnswers(record, MakeRecord(i)));
    EXPECT_EQ(record.render_ms, 12.5);
    EXPECT_EQ(record.fixes[1].localize_ms, 3.5);
  }
}

TEST_F(ResultFileTest, GoesOnAfterATornLine) {
  WriteThree();
  const std::string line = ToJsonLine(MakeRecord(3));
  Append(line.substr(0, line.size() / 2));
  {
    ResultFile reopened(file(), "title");
    EXPECT_EQ(reopened.records().size(), 3U);
    reopened.Append({MakeRecord(3)});
  }
  EXPECT_EQ(ResultFile(file(), "title").records().size(), 4U);
}

TEST_F(ResultFileTest, ALineWithoutItsEndIsTornEvenWhenItLooksWhole) {
  WriteThree();
  Append(ToJsonLine(MakeRecord(3)));
  ResultFile(file(), "title").Append({MakeRecord(3), MakeRecord(4)});
  EXPECT_EQ(ResultFile(file(), "title").records().size(), 5U);
}

TEST_F(ResultFileTest, RefusesResultsOfAnotherRun) {
  WriteThree();
  try {
    const ResultFile results(file(), "TITLE");
    FAIL() << "results of another run were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("belongs to another"));
  }
}

TEST_F(ResultFileTest, NamesTheDamagedLine) {
  WriteThree();
  Append("{\"frame\":3}\n");
  try {
    const ResultFile results(file(), "title");
    FAIL() << "a damaged line was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("floor.jsonl:5: is damaged"));
  }
}

TEST_F(ResultFileTest, RefusesAGapInTheFrames) {
  WriteThree();
  Append(ToJsonLine(MakeRecord(4)) + "\n");
  EXPECT_THROW(ResultFile(file(), "title"), InputError);
}

TEST(SameAnswers, IgnoresTimesOnly) {
  FrameRecord record = MakeRecord(0);
  record.render_ms = 99.0;
  record.fixes[0].localize_ms = 99.0;
  EXPECT_TRUE(SameAnswers(record, MakeRecord(0)));
  record.fixes[0].p_wrong *= 1.0 + 1e-12;
  EXPECT_FALSE(SameAnswers(record, MakeRecord(0)));
}

}  // namespace
}  // namespace floorloc
