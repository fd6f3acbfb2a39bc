// SPDX-License-Identifier: Apache-2.0
#include "core/map/camera_mask_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_contract.h"
#include "tests/core/map/map_damages.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::RunSql;

// A map whose second survey's camera has a mask.
class CameraMaskTableTest : public ::testing::Test {
 protected:
  CameraMaskTableTest() {
    mask_ = cv::Mat(480, 640, CV_8UC1, cv::Scalar(255));
    mask_(cv::Rect(0, 0, 30, 20)).setTo(0);
    mask_(cv::Rect(600, 470, 40, 10)).setTo(0);
    content_.info.masks = {{}, {mask_, true, {1, 2, 3}}};
    version_ = WriteMap(file_, content_);
  }

  static int Differences(const cv::Mat& a, const cv::Mat& b) { return cv::countNonZero(a != b); }

  MapContent content_ = MakeContent();
  cv::Mat mask_;
  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
  std::string version_;
};

TEST_F(CameraMaskTableTest, WhatIsWrittenIsRead) {
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadInfo();
  ASSERT_EQ(info.masks.size(), 2U);
  EXPECT_TRUE(info.masks[0].raw.empty());
  ASSERT_EQ(info.masks[1].raw.size(), mask_.size());
  EXPECT_EQ(Differences(info.masks[1].raw, mask_), 0);
  EXPECT_TRUE(info.masks[1].found);
  EXPECT_EQ(info.masks[1].picture, (std::vector<std::uint8_t>{1, 2, 3}));
  ASSERT_EQ(info.layers.size(), 5U);
  EXPECT_EQ(info.layers[1].name, "camera_mask");
  EXPECT_FALSE(info.layers[1].required);
}

TEST_F(CameraMaskTableTest, AMaskIsContentAndWithoutOneThereIsNoLayer) {
  const std::filesystem::path plain = folder_.path() / "plain.floormap";
  EXPECT_NE(WriteMap(plain, MakeContent()), version_);
  const MapInfo info = MapDatabase(plain).ReadInfo();
  EXPECT_EQ(info.layers.size(), 4U);
  EXPECT_TRUE(info.masks.empty());
}

TEST_F(CameraMaskTableTest, AMaskOfAnyShapeIsReadBack) {
  cv::RNG(5).fill(mask_, cv::RNG::UNIFORM, 0, 2);
  mask_ *= 255;
  content_.info.masks = {{mask_, false, {}}, {}};
  WriteMap(file_, content_);
  const MapInfo info = MapDatabase(file_).ReadInfo();
  EXPECT_EQ(Differences(info.masks.at(0).raw, mask_), 0);
  EXPECT_FALSE(info.masks[0].found);
}

TEST_F(CameraMaskTableTest, ACameraOfASurveyHasItsMask) {
  const MapInfo info = MapDatabase(file_).ReadInfo();
  FloorCamera camera = info.given_cameras.at(1);
  camera.floor.roi.x_max -= 0.05;
  camera.floor.resolution_m *= 2.0;
  EXPECT_EQ(Differences(MaskOfCamera(info, camera), mask_), 0);
  EXPECT_TRUE(MaskOfCamera(info, info.given_cameras.at(0)).empty());
  camera.camera.fx += 1.0;
  EXPECT_TRUE(MaskOfCamera(info, camera).empty());
}

TEST_F(CameraMaskTableTest, ADamagedMaskIsRefused) {
  const std::string bytes = testing_map::ReadBytes(file_);
  for (const std::string damage :
       {"UPDATE camera_mask SET survey = 2", "UPDATE camera_mask SET survey = -1", "UPDATE camera_mask SET runs = x''",
        "UPDATE camera_mask SET runs = x'000000'", "UPDATE camera_mask SET runs = zeroblob(64)",
        "UPDATE camera_mask SET runs = x'0000000000b00400'",
        "UPDATE camera_mask SET runs = substr(runs, 1, length(runs) - 4)",
        "UPDATE camera_mask SET runs = CAST(runs || x'01000000' AS BLOB)", "UPDATE camera_mask SET runs = 'none'",
        "UPDATE camera_mask SET picture = 7", "DROP TABLE camera_mask"}) {
    testing_map::WriteBytes(file_, bytes);
    RunSql(file_, damage);
    EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).ReadMap(); }), HasSubstr("m.floormap")) << damage;
  }
}

TEST_F(CameraMaskTableTest, VerifyFindsAnotherMask) {
  RunSql(file_, "UPDATE camera_mask SET found = 0");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("its layer 'camera_mask'"));
}

TEST_F(CameraMaskTableTest, ANewerVersionIsLeftAlone) {
  RunSql(file_, "UPDATE layer SET version = 2 WHERE name = 'camera_mask'; DROP TABLE camera_mask");
  const MapInfo info = MapDatabase(file_).ReadInfo();
  EXPECT_TRUE(info.masks.empty());
}

}  // namespace
}  // namespace floorloc
