// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/height_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mapbuilder/heights/height_scale.h"
#include "mapbuilder/simulation/simulated_camera.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

ScaleLink LinkOf(int first, int second, double scale) {
  ScaleLink link{first, second, {}};
  link.first_from_second.factor = scale;
  link.first_from_second.log_sigma = 1e-3;
  return link;
}

const std::vector<double> kHeights = {1.0, 1.2, 0.9, 0.7, 1.1, 1.3};

std::vector<ScaleLink> TrueLinks() {
  std::vector<ScaleLink> links;
  for (int i = 0; i < 6; ++i) {
    for (int j = i + 1; j < std::min(6, i + 3); ++j) {
      links.push_back(LinkOf(i, j, kHeights[static_cast<std::size_t>(j)] / kHeights[static_cast<std::size_t>(i)]));
    }
  }
  return links;
}

void ExpectTrueRatios(const std::vector<double>& log_height) {
  for (std::size_t i = 1; i < kHeights.size(); ++i) {
    EXPECT_NEAR(log_height[i] - log_height[0], std::log(kHeights[i] / kHeights[0]), 1e-3) << i;
  }
}

TEST(HeightGraph, RatiosComeFromTheLinksAndTheMeanFromThePrior) {
  const std::vector<double> log_height = SolveHeights(6, TrueLinks(), {});
  ExpectTrueRatios(log_height);
  double mean = 0.0;
  for (const double value : log_height) {
    mean += value / 6.0;
  }
  EXPECT_NEAR(mean, 0.0, 1e-6);
}

TEST(HeightGraph, WrongLinksHaveNoInfluence) {
  std::vector<ScaleLink> links = TrueLinks();
  links.push_back(LinkOf(0, 5, 0.5));
  links.push_back(LinkOf(1, 3, 2.0));
  ExpectTrueRatios(SolveHeights(6, links, {}));
}

TEST(HeightGraph, FramesWithoutLinksAreAsCalibrated) {
  const std::vector<double> log_height = SolveHeights(3, {LinkOf(0, 1, 1.2)}, {});
  EXPECT_NEAR(log_height[2], 0.0, 1e-9);
  EXPECT_THAT(LinkedGroups(3, {LinkOf(0, 1, 1.2)}), ::testing::ElementsAre(0, 0, 1));
}

TEST(HeightGraph, OptionsAreChecked) {
  OptionTable<HeightGraphOptions>()
      .Refuses("prior_sigma", &HeightGraphOptions::prior_sigma, {0.0})
      .Refuses("loss_sigmas", &HeightGraphOptions::loss_sigmas, {0.0});
}

// Six frames that drove 0.1 m each, seen from the heights above times 1.25.
class HeightScale : public ::testing::Test {
 protected:
  HeightScale() {
    LoadedSurvey loaded;
    loaded.survey.camera = MakeDownwardCamera();
    set_.surveys.push_back(loaded);
    for (std::size_t i = 0; i < kHeights.size(); ++i) {
      BuildFrame frame;
      frame.info.stamp_ns = static_cast<std::int64_t>(i) * 1'000'000'000;
      frame.info.filename = std::to_string(i);
      frame.odom_from_base = Pose2(0.1 * static_cast<double>(i), 0.0, 0.0);
      set_.frames.push_back(frame);
    }
    for (int i = 0; i + 1 < 6; ++i) {
      const double first = 1.25 * kHeights[static_cast<std::size_t>(i)];
      ScaleLink link = LinkOf(i, i + 1, 1.25 * kHeights[static_cast<std::size_t>(i) + 1] / first);
      // The point below the camera, 0.2 m ahead, moves by 0.1 m over the first's height.
      link.first_from_second.shift = 0.2 + 0.1 / first - link.first_from_second.factor * 0.2;
      links_.push_back(link);
    }
  }

  FrameSet set_;
  std::vector<ScaleLink> links_;
};

TEST_F(HeightScale, ComesFromOdometry) {
  std::vector<double> log_height = SolveHeights(6, links_, {});
  const ScaledGroups groups = ScaleByMotion(set_, {}, links_, &log_height);
  EXPECT_EQ(groups.moved, 1);
  EXPECT_EQ(groups.all, 1);
  for (std::size_t i = 0; i < kHeights.size(); ++i) {
    EXPECT_NEAR(log_height[i], std::log(1.25 * kHeights[i]), 1e-3) << i;
  }
}

TEST_F(HeightScale, KnownPosesGoFirst) {
  Trajectory poses;
  for (const BuildFrame& frame : set_.frames) {
    poses.push_back(StampedPose3::FromPose2(frame.info.stamp_ns, Pose2(2.0 * frame.odom_from_base->x(), 0.0, 0.0)));
  }
  std::vector<double> log_height = SolveHeights(6, links_, {});
  ScaleByMotion(set_, poses, links_, &log_height);
  EXPECT_NEAR(log_height[0], std::log(2.5 * kHeights[0]), 1e-3);
}

TEST_F(HeightScale, StaysWithoutMotion) {
  for (BuildFrame& frame : set_.frames) {
    frame.odom_from_base.reset();
  }
  std::vector<double> log_height = SolveHeights(6, links_, {});
  const std::vector<double> before = log_height;
  EXPECT_EQ(ScaleByMotion(set_, {}, links_, &log_height).moved, 0);
  EXPECT_EQ(log_height, before);
}

TEST_F(HeightScale, ComesFromControlPointsAndDistances) {
  std::vector<std::optional<Pose2>> poses;
  for (const BuildFrame& frame : set_.frames) {
    poses.push_back(frame.odom_from_base);
  }
  EXPECT_FALSE(ScaleByKnownLengths(set_, poses));
  Survey& survey = set_.surveys.front().survey;
  const Eigen::Vector2d px(320.0, 240.0);
  survey.known_distances.push_back({"0", px, "5", px, 0.6});  // by the poses 0.5 m
  EXPECT_NEAR(*ScaleByKnownLengths(set_, poses), 1.2, 1e-6);
  survey.known_distances.clear();
  for (const int i : {0, 2, 5}) {
    survey.control_points.push_back({std::to_string(i), px, {0.11 * i, 3.0}});
  }
  EXPECT_NEAR(*ScaleByKnownLengths(set_, poses), 1.1, 1e-6);
}

TEST_F(HeightScale, HigherCamerasSeeTheFloorLarger) {
  const FloorCamera& camera = set_.surveys.front().survey.camera;
  const Eigen::Vector2d px(100.0, 400.0);
  Keypoint keypoint;
  const Eigen::Vector2d p = camera.FloorFromRawPixel(px);
  keypoint.x_m = static_cast<float>(p.x());
  keypoint.y_m = static_cast<float>(p.y());
  keypoint.size_m = 0.01F;
  set_.frames[2].features.keypoints.push_back(keypoint);
  MultiplyHeights(1.2, &set_);
  EXPECT_DOUBLE_EQ(set_.frames[2].height_ratio, 1.2);
  const Keypoint& moved = set_.frames[2].features.keypoints.front();
  EXPECT_LT((moved.Position() - CameraOf(set_.frames[2], set_.surveys).FloorFromRawPixel(px)).norm(), 1e-6);
  EXPECT_NEAR(moved.size_m, 0.012, 1e-6);
}

}  // namespace
}  // namespace floorloc
