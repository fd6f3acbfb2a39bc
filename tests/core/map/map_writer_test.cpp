// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_map::ErrorOf;
using testing_map::FilesIn;
using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::ReadBytes;
using testing_map::TemporaryFolder;
using testing_map::WriteBytes;
using testing_map::WriteMap;

// Limits the file size of this process, to simulate a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &saved_);
    const rlimit limited{bytes, saved_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &saved_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit saved_{};
  void (*handler_)(int);
};

TEST(MapWriterTest, NothingChangesBeforeCommit) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  WriteMap(file, MakeContent());
  const std::string before = ReadBytes(file);
  {
    MapWriter writer(file);
    MapContent other = MakeContent(DescriptorType::kFloat);
    writer.WriteFrames(other.frames);
    writer.WriteKeypoints(other.keypoints, other.type);
    writer.WriteMosaicTiles(other.tiles);
    EXPECT_EQ(ReadBytes(file), before);
    MapDatabase(file).VerifyContent();
  }
  EXPECT_EQ(ReadBytes(file), before);
  EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
}

TEST(MapWriterTest, CommitReplacesTheOldMapAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  const std::string old_version = WriteMap(file, MakeContent());
  MapContent other = MakeContent();
  other.keypoints.keypoints[0].x_m += 0.1F;
  const std::string new_version = WriteMap(file, other);
  EXPECT_NE(new_version, old_version);
  EXPECT_EQ(MapDatabase(file).ReadInfo().content_version, new_version);
  EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
}

TEST(MapWriterTest, OneWriterAtATime) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  {
    MapWriter first(file);
    const std::string error = ErrorOf([&] { MapWriter second(file); });
    EXPECT_THAT(error, HasSubstr("m.floormap"));
    EXPECT_THAT(error, HasSubstr("is being written by another"));
    const MapContent content = MakeContent();
    first.WriteFrames(content.frames);
    first.WriteKeypoints(content.keypoints, content.type);
    EXPECT_NO_THROW(first.Commit(content.info, content.mosaic)) << "the refused writer must not harm the first";
  }
  MapDatabase(file).VerifyContent();
  EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
}

TEST(MapWriterTest, WritersOfTwoProcessesExcludeEachOther) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  const MapWriter first(file);
  const pid_t child = fork();
  if (child == 0) {
    try {
      MapWriter second(file);
      _exit(0);
    } catch (const MapError&) {
      _exit(42);
    }
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 42);
}

TEST(MapWriterTest, OfManyWritersAtOnceOneWinsAndItsMapIsWhole) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  const MapContent content = MakeContent();
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> written{0};
    {
      std::vector<std::jthread> threads;
      for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&] {
          try {
            WriteMap(file, content);
            ++written;
          } catch (const MapError& error) {
            EXPECT_THAT(error.what(), HasSubstr("is being written by another"));
          }
        });
      }
    }
    EXPECT_GE(written.load(), 1);
    MapDatabase(file).VerifyContent();
    EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
  }
}

TEST(MapWriterTest, LeftoversOfAKilledBuildAreReplaced) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  const pid_t child = fork();
  if (child == 0) {
    MapWriter writer(file);
    writer.WriteKeypoints(testing_map::RandomKeypoints(2000, DescriptorType::kBinary, 3), DescriptorType::kBinary);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_FALSE(std::filesystem::exists(file));
  WriteMap(file, MakeContent());
  MapDatabase(file).VerifyContent();
  EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
}

TEST(MapWriterTest, GarbageOfAnotherProgramIsReplaced) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  WriteBytes(file.string() + ".part",
             "no database at all, but long enough to have a header of one hundred bytes......");
  WriteBytes(file.string() + ".part-journal", std::string(3000, 'j'));
  WriteMap(file, MakeContent());
  MapDatabase(file).VerifyContent();
}

TEST(MapWriterTest, AFullDiskLeavesNothing) {
  const MapContent content = MakeContent();
  const TemporaryFolder probe;
  WriteMap(probe.path() / "m.floormap", content);
  const auto whole = std::filesystem::file_size(probe.path() / "m.floormap");
  for (const std::uintmax_t share : {0U, 1U, 3U, 5U, 7U, 9U}) {
    const TemporaryFolder folder;
    std::string error;
    {
      const FileSizeLimit limit(whole * share / 10);
      error = ErrorOf([&] { WriteMap(folder.path() / "m.floormap", content); });
    }
    EXPECT_THAT(error, HasSubstr("m.floormap"));
    EXPECT_THAT(error, HasSubstr("disk"));
    EXPECT_THAT(FilesIn(folder.path()), IsEmpty()) << share;
  }
}

TEST(MapWriterTest, AFullDiskKeepsTheOldMap) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "m.floormap";
  WriteMap(file, MakeContent());
  const std::string before = ReadBytes(file);
  MapContent larger = MakeContent();
  larger.keypoints = testing_map::RandomKeypoints(5000, DescriptorType::kFloat, 2);
  larger.type = DescriptorType::kFloat;
  {
    const FileSizeLimit limit(before.size() * 2);
    ErrorOf([&] { WriteMap(file, larger); });
  }
  EXPECT_EQ(ReadBytes(file), before);
  EXPECT_THAT(FilesIn(folder.path()), ElementsAre("m.floormap"));
}

TEST(MapWriterTest, RefusesPlacesThatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf([&] { MapWriter writer(folder.path() / "missing" / "m.floormap"); }), HasSubstr("m.floormap"));
  const std::string error = ErrorOf([&] { WriteMap(folder.path(), MakeContent()); });  // the target is a folder
  EXPECT_THAT(error, HasSubstr(folder.path().string()));
  EXPECT_FALSE(std::filesystem::exists(folder.path().string() + ".part"));
}

}  // namespace
}  // namespace floorloc
