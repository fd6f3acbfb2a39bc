// SPDX-License-Identifier: Apache-2.0
#include "server/store/folder_watch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>

#include "server/store/file_identity.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using std::chrono::milliseconds;

TEST(FolderWatchTest, TellsOnceWhenChangesHaveSettled) {
  const TemporaryFolder folder;
  std::atomic<int> told{0};
  const FolderWatch watch(folder.path(), {milliseconds(30), milliseconds(60'000)}, [&] { ++told; });
  for (int i = 0; i < 5; ++i) {
    std::ofstream(folder.path() / "a.floormap") << i;
  }
  std::filesystem::rename(folder.path() / "a.floormap", folder.path() / "b.floormap");
  for (int i = 0; i < 200 && told == 0; ++i) {
    std::this_thread::sleep_for(milliseconds(5));
  }
  std::this_thread::sleep_for(milliseconds(60));
  EXPECT_EQ(told, 1);
}

TEST(FolderWatchTest, LooksNowAndThenAllTheSame) {
  const TemporaryFolder folder;
  std::atomic<int> told{0};
  const FolderWatch watch(folder.path(), {milliseconds(0), milliseconds(5)}, [&] { ++told; });
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_GT(told, 2);
}

TEST(OpenedFileTest, SeesWhatIsWrittenIntoItAndWhatTakesItsName) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a";
  std::ofstream(file) << "one";
  const OpenedFile opened(file);
  EXPECT_TRUE(opened.IsUnchanged());
  std::ofstream(folder.path() / "b") << "two";
  std::filesystem::rename(folder.path() / "b", file);
  EXPECT_TRUE(opened.IsUnchanged());
  EXPECT_FALSE(opened.IsStillAt(file));
  const OpenedFile second(file);
  std::ofstream(file) << "three";
  EXPECT_FALSE(second.IsUnchanged());
  EXPECT_FALSE(OpenedFile(folder.path() / "none").IsUnchanged());
}

}  // namespace
}  // namespace floorloc
