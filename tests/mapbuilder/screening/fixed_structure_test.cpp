// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/fixed_structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "tests/option_test_support.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

constexpr int kPairs = 7;

using Overlay = std::function<void(cv::Mat*)>;

cv::Mat Noise(const cv::Size& size, double mean, double sigma) {
  cv::Mat noise(size, CV_8UC1);
  cv::RNG(7).fill(noise, cv::RNG::NORMAL, mean, sigma);
  cv::GaussianBlur(noise, noise, {}, 1.5);
  return noise;
}

// A camera over a floor that moves by a fifth of the view from image to image, with what an overlay puts over each.
class FixedStructureTest : public ::testing::Test {
 protected:
  // Rendered once for all tests.
  cv::Mat View(const Pose2& map_from_base, std::uint64_t noise_seed, const Overlay& overlay) const {
    static std::map<std::array<double, 4>, cv::Mat> rendered;
    const Pose2& pose = map_from_base;
    cv::Mat& gray = rendered[{pose.x(), pose.y(), pose.yaw(), static_cast<double>(noise_seed)}];
    if (gray.empty()) {
      RenderConditions conditions;
      conditions.read_noise = 1.8;
      conditions.noise_seed = noise_seed;
      cv::cvtColor(kFloor.View(map_from_base, conditions), gray, cv::COLOR_BGR2GRAY);
    }
    cv::Mat image = gray.clone();
    overlay(&image);
    return image;
  }

  std::vector<MovedImages> Pairs(double step_m, const Overlay& overlay) const {
    std::vector<MovedImages> pairs;
    for (std::uint64_t i = 0; i < kPairs; ++i) {
      const Pose2 first = kFloor.BaseForView(0.35 + 0.06 * static_cast<double>(i), 0.45, 0.1 * static_cast<double>(i));
      const Pose2 second = first * Pose2(step_m, 0.2 * step_m, 0.0);
      pairs.push_back({View(first, 2 * i + 1, overlay), View(second, 2 * i + 2, overlay), first.Between(second)});
    }
    return pairs;
  }

  FixedStructure Find(const std::vector<MovedImages>& pairs) const {
    return FindFixedStructure(kFloor.camera(), pairs, FixedStructureOptions{});
  }

  static void ExpectCovers(const cv::Mat& mask, const cv::Mat& part) {
    ASSERT_FALSE(mask.empty());
    const double covered = cv::countNonZero((mask == 0) & part);
    EXPECT_GE(covered, 0.95 * cv::countNonZero(part));
    const double wrong = cv::countNonZero((mask == 0) & ~part);
    EXPECT_LE(wrong, 0.02 * static_cast<double>(mask.total()));
  }

  inline static const SyntheticFloor kFloor{1};
  cv::Size size_{kFloor.camera().camera.width_px, kFloor.camera().camera.height_px};
  cv::Rect corner_{0, size_.height / 2, size_.width * 3 / 10, size_.height / 2};
};

TEST_F(FixedStructureTest, ATexturedPlateIsMaskedAndTheFloorIsNot) {
  const cv::Mat plate = Noise(size_, 128, 60);
  const FixedStructure found = Find(Pairs(0.07, [&](cv::Mat* image) { plate(corner_).copyTo((*image)(corner_)); }));
  EXPECT_TRUE(found.decided);
  EXPECT_EQ(found.pairs, kPairs);
  cv::Mat part = cv::Mat::zeros(size_, CV_8U);
  part(corner_).setTo(255);
  ExpectCovers(found.mask, part);
}

TEST_F(FixedStructureTest, APlainPartIsMaskedUpToItsEdge) {
  const FixedStructure found = Find(Pairs(0.07, [&](cv::Mat* image) { (*image)(corner_).setTo(30); }));
  cv::Mat part = cv::Mat::zeros(size_, CV_8U);
  part(corner_).setTo(255);
  ExpectCovers(found.mask, part);
}

TEST_F(FixedStructureTest, ExposureMayChangeFromImageToImage) {
  const cv::Mat plate = Noise(size_, 128, 40);
  int image_number = 0;
  const FixedStructure found = Find(Pairs(0.07, [&](cv::Mat* image) {
    plate(corner_).copyTo((*image)(corner_));
    image->convertTo(*image, -1, ++image_number % 2 == 0 ? 1.2 : 0.8);
  }));
  cv::Mat part = cv::Mat::zeros(size_, CV_8U);
  part(corner_).setTo(255);
  ExpectCovers(found.mask, part);
}

TEST_F(FixedStructureTest, AFloorAloneIsNotMasked) {
  const FixedStructure found = Find(Pairs(0.07, [](cv::Mat*) {}));
  EXPECT_TRUE(found.decided);
  EXPECT_TRUE(found.mask.empty());
}

TEST_F(FixedStructureTest, LightThroughWhichTheFloorMovesIsNotMasked) {
  cv::Mat light(size_, CV_32F, cv::Scalar(1.0));
  light(corner_).setTo(0.5);
  cv::GaussianBlur(light, light, {}, 6.0);
  const FixedStructure found = Find(Pairs(0.07, [&](cv::Mat* image) {
    cv::Mat lit;
    image->convertTo(lit, CV_32F);
    cv::Mat(lit.mul(light)).convertTo(*image, CV_8U);
  }));
  EXPECT_TRUE(found.decided);
  EXPECT_TRUE(found.mask.empty());
}

TEST_F(FixedStructureTest, ACameraAtRestProvesNothing) {
  const cv::Mat plate = Noise(size_, 128, 60);
  std::vector<MovedImages> pairs = Pairs(0.0, [&](cv::Mat* image) { plate(corner_).copyTo((*image)(corner_)); });
  EXPECT_FALSE(Find(pairs).decided);
  for (MovedImages& pair : pairs) {
    pair.first_from_second = Pose2(0.07, 0.0, 0.0);  // as a registration that went wrong says
  }
  const FixedStructure found = Find(pairs);
  EXPECT_FALSE(found.decided);
  EXPECT_TRUE(found.mask.empty());
}

TEST_F(FixedStructureTest, AFloorWithoutStructureProvesNothing) {
  const cv::Mat plate = Noise(size_, 128, 60);
  const FixedStructure found = Find(Pairs(0.07, [&](cv::Mat* image) {
    cv::RNG noise(static_cast<std::uint64_t>(cv::sum(*image)[0]));
    noise.fill(*image, cv::RNG::NORMAL, 128, 1.5);
    plate(corner_).copyTo((*image)(corner_));
  }));
  EXPECT_FALSE(found.decided);
  EXPECT_TRUE(found.mask.empty());
}

// A line along the motion, such as a joint between tiles, looks the same whether it stands still or moves.
TEST_F(FixedStructureTest, LinesAlongTheMotionAreNotMasked) {
  std::vector<MovedImages> pairs;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const Pose2 first = kFloor.BaseForView(0.35 + 0.06 * static_cast<double>(i), 0.45, 0.0);
    const Pose2 second = first * Pose2(0.07, 0.0, 0.0);
    const auto lines = [&](cv::Mat* image) {
      for (const double y_m : {-0.06, 0.06}) {  // in the base frame, x is the direction of motion
        std::vector<cv::Point> line;
        for (double x_m = kFloor.camera().floor.roi.x_min - 0.05; x_m < kFloor.camera().floor.roi.x_max + 0.05;
             x_m += 0.01) {
          const Eigen::Vector2d px = kFloor.camera().RawPixelFromFloor({x_m, y_m});
          line.emplace_back(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())));
        }
        cv::polylines(*image, line, false, cv::Scalar(25), 9);
      }
    };
    pairs.push_back({View(first, 2 * i + 1, lines), View(second, 2 * i + 2, lines), first.Between(second)});
  }
  const FixedStructure found = Find(pairs);
  EXPECT_TRUE(found.decided);
  EXPECT_TRUE(found.mask.empty());
}

TEST_F(FixedStructureTest, FewPairsProveNothing) {
  const cv::Mat plate = Noise(size_, 128, 60);
  std::vector<MovedImages> pairs = Pairs(0.07, [&](cv::Mat* image) { plate(corner_).copyTo((*image)(corner_)); });
  pairs.resize(5);
  EXPECT_FALSE(Find(pairs).decided);
}

TEST(FixedStructureOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<FixedStructureOptions>()
      .Refuses("width_px", &FixedStructureOptions::width_px, {0})
      .Refuses("min_pairs", &FixedStructureOptions::min_pairs, {0})
      .Refuses("window_px", &FixedStructureOptions::window_px, {1, 4})
      .Refuses("light_px", &FixedStructureOptions::light_px, {5, 12})
      .Refuses("noise", &FixedStructureOptions::noise, {0.0})
      .Refuses("min_moving_share", &FixedStructureOptions::min_moving_share, {0.0, 1.0})
      .Refuses("min_decided_share", &FixedStructureOptions::min_decided_share, {0.0, 1.0})
      .Refuses("min_standing", &FixedStructureOptions::min_standing, {0.0, 1.0})
      .Refuses("min_lead", &FixedStructureOptions::min_lead, {0.0, 1.0})
      .Refuses("min_vote_share", &FixedStructureOptions::min_vote_share, {0.0, 1.0})
      .Refuses("max_floor_share", &FixedStructureOptions::max_floor_share, {0.0, 1.0})
      .Refuses("max_variation", &FixedStructureOptions::max_variation, {0.0, 1.0})
      .Refuses("max_relative_variation", &FixedStructureOptions::max_relative_variation, {0.0, 1.0})
      .Refuses("min_seed_share", &FixedStructureOptions::min_seed_share, {0.0, 1.0})
      .Refuses("margin_px", &FixedStructureOptions::margin_px, {-1})
      .Refuses("min_region_px", &FixedStructureOptions::min_region_px, {0});
}

}  // namespace
}  // namespace floorloc
