// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/camera_copies.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

constexpr double kResolutionM = 2e-3;
constexpr int kTilePx = 1536;

cv::Mat Noise(const cv::Size& size, std::uint64_t seed) {
  cv::Mat noise(size, CV_32F);
  cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0.0, 60.0);
  cv::GaussianBlur(noise, noise, {0, 0}, 1.5);
  noise.convertTo(noise, CV_8U, 1.0, 128.0);
  return noise;
}

// A mosaic of one tile, of a survey in lanes over a floor of 3 x 3 m.
class CameraCopiesTest : public testing::Test {
 protected:
  CameraCopiesTest() : mosaic_(Noise({kTilePx, kTilePx}, 1)) {
    FloorCamera camera;
    camera.floor.roi = {-0.15, 0.15, -0.2, 0.2};
    map_.info.cameras = {camera};
    map_.mosaic = {kTilePx, 0, kResolutionM};
    for (int lane = 0; lane < 15; ++lane) {
      for (int i = 0; i < 18; ++i) {
        const bool back = lane % 2 == 1;
        MapFrame frame;
        frame.stamp_ns = static_cast<std::int64_t>(frames_.size());
        const double along = 0.3 + 0.14 * (back ? 17 - i : i) + 0.013 * std::sin(7.0 * i + lane);
        frame.map_from_base = Pose2(along, 0.3 + 0.172 * lane, back ? std::numbers::pi : 0.02);
        frames_.push_back(frame);
      }
    }
  }

  // Every nth frame's place shows the part, of 0.1 x 0.1 m at the left behind.
  void ShowPart(std::size_t nth) {
    const cv::Mat part = Noise({50, 50}, 2);
    for (std::size_t i = 0; i < frames_.size(); i += nth) {
      for (int v = 0; v < part.rows; ++v) {
        for (int u = 0; u < part.cols; ++u) {
          const Eigen::Vector2d base(-0.05 - v * kResolutionM, 0.2 - u * kResolutionM);
          const Eigen::Vector2d at = frames_[i].map_from_base * base;
          mosaic_.at<std::uint8_t>(kTilePx - 1 - static_cast<int>(at.y() / kResolutionM),
                                   static_cast<int>(at.x() / kResolutionM)) = part.at<std::uint8_t>(v, u);
        }
      }
    }
  }

  std::vector<CameraCopies> Find() const {
    std::vector<std::uint8_t> encoded;
    cv::imencode(".png", mosaic_, encoded);
    return FindCameraCopies(map_, frames_, [&](const TileId& tile) {
      return tile.x == 0 && tile.y == 0 ? std::optional(encoded) : std::nullopt;
    });
  }

  cv::Mat mosaic_;
  FloorMap map_;
  std::vector<MapFrame> frames_;
};

TEST_F(CameraCopiesTest, APartInEveryFifthPlaceIsFoundWhereItIs) {
  ShowPart(5);
  const std::vector<CameraCopies> found = Find();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].survey, 0);
  EXPECT_EQ(found[0].frames, 270);
  EXPECT_NEAR(found[0].share, 0.1 * 0.1 / (0.3 * 0.4), 0.04);
  const cv::Mat& blocks = found[0].blocks;
  const cv::Rect lower_left(0, blocks.rows / 2, blocks.cols / 2, blocks.rows - blocks.rows / 2);
  EXPECT_EQ(cv::countNonZero(blocks(lower_left)), cv::countNonZero(blocks));
}

TEST_F(CameraCopiesTest, ACleanFloorHasNone) { EXPECT_TRUE(Find().empty()); }

TEST_F(CameraCopiesTest, TilesThatRepeatUnderTheLanesHaveNone) {
  // Joints every 86 mm: half of the distance of the lanes.
  for (int at = 0; at < kTilePx; at += 43) {
    mosaic_(cv::Rect(at, 0, 2, kTilePx)).setTo(40);
    mosaic_(cv::Rect(0, at, kTilePx, 2)).setTo(40);
  }
  EXPECT_TRUE(Find().empty());
}

TEST_F(CameraCopiesTest, FewFramesProveNothing) {
  ShowPart(1);
  frames_.resize(20);
  EXPECT_TRUE(Find().empty());
}

TEST(CameraCopyOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<CameraCopyOptions>()
      .Refuses("max_frames", &CameraCopyOptions::max_frames, {1})
      .Refuses("min_frames", &CameraCopyOptions::min_frames, {1})
      .Refuses("blocks", &CameraCopyOptions::blocks, {3, 129})
      .Refuses("controls", &CameraCopyOptions::controls, {0})
      .Refuses("min_shift", &CameraCopyOptions::min_shift, {0.0})
      .Refuses("max_shift", &CameraCopyOptions::max_shift, {0.1})
      .Refuses("min_floor", &CameraCopyOptions::min_floor, {0.0, 1.1})
      .Refuses("min_sigmas", &CameraCopyOptions::min_sigmas, {0.0})
      .Refuses("min_correlation", &CameraCopyOptions::min_correlation, {0.0, 1.0})
      .Refuses("min_side_blocks", &CameraCopyOptions::min_side_blocks, {0})
      .Refuses("min_share", &CameraCopyOptions::min_share, {0.0, 1.0});
}

}  // namespace
}  // namespace floorloc
