// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/floor_texture.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

FloorTextureOptions Small(const std::string& source) {
  FloorTextureOptions options;
  options.source = source;
  options.width_m = 0.5;
  options.height_m = 0.1;
  options.resolution_m = 0.001;
  return options;
}

TEST(FloorTextureTest, StripesAlternateWithTheFirstTexture) {
  const cv::Mat concrete = MakeFloorTexture(Small("concrete")).bgr;
  const cv::Mat wood = MakeFloorTexture(Small("wood")).bgr;
  FloorTextureOptions options = Small("concrete");
  options.stripes = "wood";
  options.stripe_m = 0.1;
  const cv::Mat striped = MakeFloorTexture(options).bgr;
  ASSERT_EQ(striped.size(), concrete.size());
  // 2 cm about each border are mixed.
  for (int stripe = 0; stripe < 5; ++stripe) {
    const cv::Range middle(100 * stripe + 12, 100 * stripe + 88);
    const cv::Mat& expected = stripe % 2 == 0 ? concrete : wood;
    EXPECT_EQ(cv::norm(striped.colRange(middle), expected.colRange(middle), cv::NORM_INF), 0.0) << stripe;
  }
}

TEST(FloorTextureTest, StripesAreNotTooNarrow) {
  FloorTextureOptions options = Small("concrete");
  options.stripe_m = 0.01;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
