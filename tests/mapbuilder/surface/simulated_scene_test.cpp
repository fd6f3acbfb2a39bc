// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/simulated_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "mapbuilder/surface/confusion.h"

namespace floorloc {
namespace {

TEST(SimulatedScene, HasSeveralSurfacesWithDepthAndHoles) {
  const SceneOptions options;
  const SurfaceScene scene = SimulateScene(options, 4);
  scene.image.Check();
  const cv::Mat_<int> labels = scene.class_of_pixel;
  const std::set<int> classes(labels.begin(), labels.end());
  EXPECT_GE(classes.size(), 3U);
  EXPECT_LE(*classes.rbegin(), 4);
  const double holes = 1.0 - cv::countNonZero(scene.image.depth_mm) / static_cast<double>(labels.total());
  EXPECT_NEAR(holes, options.hole_share, 0.02);
  // The optical axis meets the floor at height / sin(pitch).
  const cv::Mat middle = scene.image.depth_mm(cv::Rect(310, 238, 20, 4));
  EXPECT_NEAR(cv::mean(middle, middle > 0)[0], 1000.0 * options.camera_height_m / std::sin(options.camera_pitch_rad),
              5.0);
}

TEST(SimulatedScene, IntensitiesHaveTheMeasuredMeanAndSpread) {
  SceneOptions options;
  options.surface_variance = 0.0;
  options.patch_variance = 0.0;
  const SurfaceScene scene = SimulateScene(options, 7);
  for (int c = 0; c < 5; ++c) {
    const cv::Mat mask = (scene.class_of_pixel == c) & (scene.image.depth_mm > 0);
    if (cv::countNonZero(mask) > 20'000) {
      cv::Scalar mean;
      cv::Scalar sigma;
      cv::meanStdDev(scene.image.intensity, mean, sigma, mask);
      EXPECT_NEAR(mean[0] / kIntensityUnits, IntensityOf(c).mean, 0.05) << SceneClasses()[static_cast<std::size_t>(c)];
      EXPECT_NEAR(sigma[0] / kIntensityUnits, IntensityOf(c).sigma, 0.15);
    }
  }
}

TEST(SimulatedScene, IsDeterministicAndDiffersBySeed) {
  SceneOptions options;
  options.size_px = {80, 60};
  options.focal_px = 65.0;
  const SurfaceScene once = SimulateScene(options, 1);
  EXPECT_EQ(cv::norm(once.image.color, SimulateScene(options, 1).image.color, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(once.image.intensity, SimulateScene(options, 1).image.intensity, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(once.image.color, SimulateScene(options, 2).image.color, cv::NORM_INF), 0.0);
  options.camera_pitch_rad = 0.2;
  EXPECT_THROW(SimulateScene(options, 1), std::invalid_argument) << "the horizon is in view";
}

TEST(Confusion, SharesAreOfWhatWasMarked) {
  Confusion confusion(2);
  confusion.Add(0, 0, 30.0);
  confusion.Add(0, 1, 10.0);
  confusion.Add(1, 1, 5.0);
  EXPECT_DOUBLE_EQ(confusion.Share(0, 1), 0.25);
  EXPECT_DOUBLE_EQ(confusion.MeanShare(), 0.875);
  EXPECT_DOUBLE_EQ(confusion.RightShare(), 35.0 / 45.0);
}

}  // namespace
}  // namespace floorloc
