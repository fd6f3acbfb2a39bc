// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/state_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/io/input_error.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

class StateFolderTest : public testing::Test {
 protected:
  void Write(const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << "precious";
  }

  TemporaryFolder parent_;
  fs::path folder_ = parent_.path() / "state";
};

TEST_F(StateFolderTest, ANewAndAnEmptyFolderAreTaken) {
  ClearStateFolder(folder_, "a_benchmark");
  EXPECT_TRUE(fs::is_directory(folder_));
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  ClearStateFolder(folder_, "a_benchmark");
}

TEST_F(StateFolderTest, WhatItMadeItselfIsCleared) {
  OpenStateFolder(folder_, "a_benchmark");
  Write("maps/floor.floormap");
  OpenStateFolder(folder_, "a_benchmark");
  EXPECT_TRUE(fs::exists(folder_ / "maps/floor.floormap"));
  ClearStateFolder(folder_, "a_benchmark");
  EXPECT_FALSE(fs::exists(folder_ / "maps"));
  Write("maps/floor.floormap");
  ClearStateFolder(folder_, "a_benchmark");  // it is still its own
  EXPECT_FALSE(fs::exists(folder_ / "maps"));
}

TEST_F(StateFolderTest, AFolderOfTheUsersOrOfAnotherBenchmarkIsLeftAlone) {
  Write("thesis/chapter1.txt");
  OpenStateFolder(folder_, "a_benchmark");  // does not make it the benchmark's
  const auto refused = testing::ThrowsMessage<InputError>(testing::HasSubstr("was not made by a_benchmark"));
  EXPECT_THAT([&] { ClearStateFolder(folder_, "a_benchmark"); }, refused);
  EXPECT_TRUE(fs::exists(folder_ / "thesis/chapter1.txt"));
  fs::remove_all(folder_);
  OpenStateFolder(folder_, "another_benchmark");
  Write("result.json");
  EXPECT_THAT([&] { ClearStateFolder(folder_, "a_benchmark"); }, refused);
  EXPECT_TRUE(fs::exists(folder_ / "result.json"));
}

TEST_F(StateFolderTest, AFileIsRefused) {
  std::ofstream(folder_) << "precious";
  EXPECT_THROW(ClearStateFolder(folder_, "a_benchmark"), InputError);
  EXPECT_TRUE(fs::is_regular_file(folder_));
}

}  // namespace
}  // namespace floorloc
