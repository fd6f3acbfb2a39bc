// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/robust_pose_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

constexpr int kLanes = 8;
constexpr int kPerLane = 20;
constexpr double kStepM = 0.15;
constexpr double kLaneM = 0.2;
constexpr double kTileM = 0.3;

// A survey in lanes of alternating direction. Odometry connects consecutive frames; links connect these and
// neighbouring lanes.
class Lanes {
 public:
  explicit Lanes(std::uint32_t seed) : random_(seed) {
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int i = 0; i < kPerLane; ++i) {
        const bool back = lane % 2 == 1;
        truth_.emplace_back(kStepM * (back ? kPerLane - 1 - i : i), kLaneM * lane, back ? std::numbers::pi : 0.0);
      }
    }
    for (int i = 0; i + 1 < Count(); ++i) {
      graph.odometry.push_back(Measure(i, i + 1, 5e-3, 0.02));
      graph.links.push_back(Measure(i, i + 1, 3e-4, 6e-4));
    }
    for (int i = 0; i + kPerLane < Count(); ++i) {
      graph.links.push_back(Measure(i, NextLane(i), 3e-4, 6e-4));
    }
    true_links_ = static_cast<int>(graph.links.size());
    graph.fixed = {0};
  }

  // Loop closures that are wrong by the same tile, so that they agree with each other.
  void AddTileClosures(int count) {
    for (int i = 0; i < count; ++i) {
      Link link = RandomClosure();
      const Pose2 one_tile = truth_[static_cast<std::size_t>(link.first)].Inverse() * Pose2(kTileM, 0.0, 0.0) *
                             truth_[static_cast<std::size_t>(link.first)];
      link.first_from_second = one_tile * link.first_from_second;
      graph.links.push_back(link);
    }
  }
  void AddRandomClosures(int count) {
    std::uniform_real_distribution<double> position(-0.4, 0.4);
    closure_ = static_cast<int>(random_() % 100);
    for (int i = 0; i < count; ++i) {
      Link link = RandomClosure();
      link.first_from_second = Pose2(position(random_), position(random_), 8.0 * position(random_));
      graph.links.push_back(link);
    }
  }

  // Starts from chained poses as the builder does: by the links with most inliers, true or false.
  RobustPoseGraphSummary Solve() {
    graph.map_from_base =
        ChainPoses(std::vector<Pose2>(static_cast<std::size_t>(Count()), truth_.front()), graph.links, graph.odometry);
    return OptimizePosesRobustly(&graph);
  }

  double WorstErrorM() const {
    double worst = 0.0;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      worst = std::max(worst, (graph.map_from_base[i].translation() - truth_[i].translation()).norm());
    }
    return worst;
  }
  int true_links() const { return true_links_; }

  PoseGraph graph;

 private:
  int Count() const { return static_cast<int>(truth_.size()); }
  static int NextLane(int i) {
    const int lane = i / kPerLane;
    return (lane + 1) * kPerLane + kPerLane - 1 - i % kPerLane;
  }
  Link Measure(int first, int second, double sigma_m, double sigma_rad) {
    std::normal_distribution<double> normal;
    const Pose2 noise(sigma_m * normal(random_), sigma_m * normal(random_), sigma_rad * normal(random_));
    Link link;
    link.first = first;
    link.second = second;
    link.first_from_second =
        truth_[static_cast<std::size_t>(first)].Between(truth_[static_cast<std::size_t>(second)]) * noise;
    link.covariance = Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad).asDiagonal();
    link.inliers = 100 + static_cast<int>(random_() % 100);
    return link;
  }
  // Never repeats a pair, so that no frame gets more false than true links.
  Link RandomClosure() {
    constexpr int kCoprime = 59;
    closure_ = (closure_ + kCoprime) % (Count() - kPerLane);
    return Measure(closure_, NextLane(closure_), 3e-4, 6e-4);
  }

  std::mt19937 random_;
  std::vector<Pose2> truth_;
  int true_links_ = 0;
  int closure_ = 0;
};

TEST(RobustPoseGraphTest, WithoutFalseLinksNothingIsRejected) {
  Lanes lanes(1);
  EXPECT_EQ(lanes.Solve().rejected_links, 0);
  EXPECT_LT(lanes.WorstErrorM(), 3e-3);
}

TEST(RobustPoseGraphTest, FalseLoopClosuresOfOneTileAreFound) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    Lanes lanes(seed);
    lanes.AddTileClosures(60);
    EXPECT_EQ(lanes.Solve().rejected_links, 60) << seed;
    EXPECT_EQ(static_cast<int>(lanes.graph.links.size()), lanes.true_links()) << seed;
    EXPECT_LT(lanes.WorstErrorM(), 3e-3) << seed;
  }
}

TEST(RobustPoseGraphTest, AThirdOfFalseLinksIsFound) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    Lanes lanes(seed);
    lanes.AddRandomClosures(90);
    lanes.AddTileClosures(50);
    EXPECT_EQ(lanes.Solve().rejected_links, 140) << seed;
    EXPECT_LT(lanes.WorstErrorM(), 3e-3) << seed;
  }
}

}  // namespace
}  // namespace floorloc
