// SPDX-License-Identifier: Apache-2.0
#include "core/io/text_file.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using testing_io::ErrorOf;
using testing_io::TemporaryFolder;

std::size_t CountEntries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

TEST(TextFile, WritesAndReadsBackEveryByte) {
  const TemporaryFolder folder;
  std::string content;
  for (int i = 0; i < 300'000; ++i) {
    content += static_cast<char>(i * 31 % 256);
  }
  WriteFileAtomically(folder.path() / "a.bin", content);
  EXPECT_EQ(ReadTextFile(folder.path() / "a.bin"), content);
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(folder.path() / "a.bin");
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), content);
  EXPECT_EQ(CountEntries(folder.path()), 1u) << "a temporary file stayed";
}

TEST(TextFile, ReplacesAnOldFileAndLeavesOthersReadable) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "a", "old");
  WriteFileAtomically(folder.path() / "a", "");
  EXPECT_EQ(ReadTextFile(folder.path() / "a"), "");
  struct stat status {};
  ASSERT_EQ(stat((folder.path() / "a").c_str(), &status), 0);
  const mode_t mask = umask(0);
  umask(mask);
  EXPECT_EQ(status.st_mode & 0777, 0666 & ~mask);
}

TEST(TextFile, WritesRelativeNames) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  WriteFileAtomically("plain.txt", "x");
  std::filesystem::current_path(before);
  EXPECT_EQ(ReadTextFile(folder.path() / "plain.txt"), "x");
}

TEST(TextFile, ALeftoverTemporaryFileOfACrashIsNoObstacle) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / ("a.tmp-" + std::to_string(getpid()) + "-0")) << "rest of a crash";
  WriteFileAtomically(folder.path() / "a", "new");
  EXPECT_EQ(ReadTextFile(folder.path() / "a"), "new");
}

TEST(TextFile, FailedWriteNamesTheFileAndLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf([&] { WriteFileAtomically(folder.path() / "no" / "a", "x"); }),
              ::testing::AllOf(HasSubstr("no/a: cannot be written (No such file or directory)"), HasSubstr("check")));
  // The target is a folder, so that only the rename fails.
  std::filesystem::create_directory(folder.path() / "b");
  EXPECT_THAT(ErrorOf([&] { WriteFileAtomically(folder.path() / "b", "x"); }), HasSubstr("b: cannot be written"));
  EXPECT_EQ(CountEntries(folder.path()), 1u) << "a temporary file stayed";
}

TEST(TextFile, FullDiskKeepsTheOldFile) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "a", "old");
  // A limit on the file size makes write() fail half-way, like a full disk.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = ErrorOf([&] { WriteFileAtomically(folder.path() / "a", std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(message, HasSubstr("a: cannot be written (File too large)"));
  EXPECT_EQ(ReadTextFile(folder.path() / "a"), "old");
  EXPECT_EQ(CountEntries(folder.path()), 1u) << "a temporary file stayed";
}

TEST(TextFile, UnreadableFilesAreNamedWithTheReason) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf([&] { ReadTextFile(folder.path() / "none"); }),
              HasSubstr("none: cannot be opened (No such file or directory)"));
  EXPECT_THAT(ErrorOf([&] { ReadTextFile(folder.path()); }), HasSubstr("is a folder"));
  WriteFileAtomically(folder.path() / "big", std::string(1001, 'x'));
  EXPECT_THAT(ErrorOf([&] { ReadTextFile(folder.path() / "big", 1000); }), HasSubstr("larger than the limit of 1000"));
  EXPECT_EQ(ReadTextFile(folder.path() / "big", 1001).size(), 1001u);
}

}  // namespace
}  // namespace floorloc
