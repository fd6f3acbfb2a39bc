// SPDX-License-Identifier: Apache-2.0
#include "core/map/upright_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_layers.h"
#include "tests/core/map/map_damages.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MapContent;
using testing_map::RunSql;

// A map with upright descriptors, which are random.
class UprightTableTest : public ::testing::Test {
 protected:
  UprightTableTest() {
    content_.info.extractor = ExtractorOptions();
    content_.keypoints.upright = cv::Mat(static_cast<int>(content_.keypoints.size()), 32, CV_8UC1);
    cv::RNG(9).fill(content_.keypoints.upright, cv::RNG::UNIFORM, 0, 256);
    WriteMap(file_, content_);
  }

  MapContent content_ = testing_map::MakeContent();
  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
};

// Keypoints are written by tiles: their order changes, and that of both kinds of descriptors with it.
TEST_F(UprightTableTest, EachKeypointKeepsItsDescriptors) {
  const MapKeypoints read = MapDatabase(file_).ReadVerifiedMap().keypoints;
  ASSERT_EQ(read.upright.rows, content_.keypoints.upright.rows);
  for (int i = 0; i < read.upright.rows; ++i) {
    int from = 0;
    while (cv::norm(read.descriptors.row(i), content_.keypoints.descriptors.row(from), cv::NORM_HAMMING) > 0.0) {
      ASSERT_LT(++from, content_.keypoints.descriptors.rows);
    }
    EXPECT_EQ(cv::norm(read.upright.row(i), content_.keypoints.upright.row(from), cv::NORM_HAMMING), 0.0) << i;
  }
}

TEST_F(UprightTableTest, WithoutThemThereIsNoLayer) {
  content_.keypoints.upright = cv::Mat();
  const std::filesystem::path plain = folder_.path() / "plain.floormap";
  WriteMap(plain, content_);
  const FloorMap map = MapDatabase(plain).ReadVerifiedMap();
  EXPECT_TRUE(map.keypoints.upright.empty());
  EXPECT_FALSE(HasLayer(map.info.layers, kUprightLayer));
  EXPECT_TRUE(HasLayer(MapDatabase(file_).ReadInfo().layers, kUprightLayer));
}

TEST_F(UprightTableTest, AnExtractorWithoutThemLeavesThemUnread) {
  content_.info.extractor.type = ExtractorType::kOrb;
  WriteMap(file_, content_);
  EXPECT_TRUE(MapDatabase(file_).ReadMap().keypoints.upright.empty());
}

TEST_F(UprightTableTest, DamageIsNamed) {
  for (const std::string damage :
       {"DELETE FROM keypoint_upright WHERE x = 0", "UPDATE keypoint_upright SET checksum = checksum + 1 WHERE x = 0",
        "UPDATE keypoint_upright SET descriptor = x'00' WHERE x = 0",
        "UPDATE keypoint_upright SET descriptor = 'text' WHERE x = 0", "UPDATE keypoint_upright SET x = x + 100"}) {
    WriteMap(file_, content_);
    RunSql(file_, damage);
    EXPECT_THAT(ErrorOf([&] { MapDatabase(file_).ReadMap(); }), HasSubstr("upright tile")) << damage;
  }
}

}  // namespace
}  // namespace floorloc
