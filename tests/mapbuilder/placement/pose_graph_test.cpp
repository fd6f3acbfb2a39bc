// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/pose_graph.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

constexpr double kSigmaM = 5e-4;
constexpr double kSigmaRad = 1e-3;

// Two rounds on a circle of 2 m; every frame is linked to the next ones and to those of the other round.
class Loop {
 public:
  explicit Loop(std::uint32_t seed) : random_(seed) {
    for (int i = 0; i < kFrames; ++i) {
      const double turn = 4.0 * std::numbers::pi * i / kFrames;
      truth.emplace_back(2.0 * std::cos(turn), 2.0 * std::sin(turn), turn + 0.5 * std::numbers::pi);
    }
    for (int i = 0; i + 1 < kFrames; ++i) {
      AddLink(i, i + 1);
    }
    for (int i = 0; i + kFrames / 2 < kFrames; ++i) {
      AddLink(i, i + kFrames / 2);
    }
    graph.map_from_base = ChainPoses(std::vector<Pose2>(kFrames, truth.front()), graph.links, {});
    graph.fixed = {0};
  }

  void AddFalseLinks(int count) {
    for (int i = 0; i < count; ++i) {
      const int first = static_cast<int>(random_() % kFrames);
      const int second = (first + 5 + static_cast<int>(random_() % 20)) % kFrames;
      Link link = Measure(first, second);
      link.first_from_second = link.first_from_second * Pose2(0.3 + 0.1 * i, -0.2, 0.5);
      graph.links.push_back(link);
    }
  }

  double WorstErrorM() const {
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, (graph.map_from_base[i].translation() - truth[i].translation()).norm());
    }
    return worst;
  }

  static constexpr int kFrames = 80;
  std::vector<Pose2> truth;
  PoseGraph graph;

 private:
  Link Measure(int first, int second) {
    std::normal_distribution<double> normal;
    const Pose2 motion = truth[static_cast<std::size_t>(first)].Between(truth[static_cast<std::size_t>(second)]);
    Link link;
    link.first = first;
    link.second = second;
    link.first_from_second = Pose2(motion.x() + kSigmaM * normal(random_), motion.y() + kSigmaM * normal(random_),
                                   motion.yaw() + kSigmaRad * normal(random_));
    link.covariance = Eigen::Vector3d(kSigmaM * kSigmaM, kSigmaM * kSigmaM, kSigmaRad * kSigmaRad).asDiagonal();
    link.inliers = 100;
    return link;
  }
  void AddLink(int first, int second) { graph.links.push_back(Measure(first, second)); }

  std::mt19937 random_;
};

TEST(PoseGraphTest, RecoversALoop) {
  Loop loop(1);
  const double before_m = loop.WorstErrorM();
  const PoseGraphSummary summary = OptimizePoses(&loop.graph);
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(loop.WorstErrorM(), 0.03);
  EXPECT_LT(loop.WorstErrorM(), before_m);
  EXPECT_GT(summary.rms_sigma, 0.3);  // 120 links for 79 poses
  EXPECT_LT(summary.rms_sigma, 1.0);
}

TEST(PoseGraphTest, TheFixedFrameStaysPut) {
  Loop loop(2);
  loop.graph.fixed = {7};
  const Pose2 before = loop.graph.map_from_base[7];
  OptimizePoses(&loop.graph);
  EXPECT_EQ(loop.graph.map_from_base[7].x(), before.x());
  EXPECT_EQ(loop.graph.map_from_base[7].yaw(), before.yaw());
}

TEST(PoseGraphTest, FalseLinksDoNotBendTheMap) {
  Loop loop(3);
  const std::size_t right_links = loop.graph.links.size();
  loop.AddFalseLinks(static_cast<int>(right_links / 10));
  OptimizePoses(&loop.graph);
  EXPECT_LT(loop.WorstErrorM(), 0.04);
  for (std::size_t i = 0; i < loop.graph.links.size(); ++i) {
    const Link& link = loop.graph.links[i];
    const double residual = LinkResidual(link, loop.graph.map_from_base[static_cast<std::size_t>(link.first)],
                                         loop.graph.map_from_base[static_cast<std::size_t>(link.second)]);
    if (i < right_links) {
      EXPECT_LT(residual, 6.0) << link.first << " " << link.second;
    } else {
      EXPECT_GT(residual, 50.0) << link.first << " " << link.second;
    }
  }
}

TEST(PoseGraphTest, ControlPointsPinTheFrame) {
  Loop loop(4);
  const Pose2 elsewhere(100.0, -50.0, 2.0);  // the start in the surveyor's frame
  for (const int frame : {3, 20, 45, 70}) {
    const Eigen::Vector2d point(0.2, 0.1);
    loop.graph.control_points.push_back(
        {frame, point, elsewhere * (loop.truth[static_cast<std::size_t>(frame)] * point), 1e-3});
  }
  loop.graph.fixed.clear();
  for (Pose2& pose : loop.graph.map_from_base) {
    pose = elsewhere * pose;
  }
  EXPECT_TRUE(OptimizePoses(&loop.graph).converged);
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    EXPECT_LT((loop.graph.map_from_base[i].translation() - (elsewhere * loop.truth[i]).translation()).norm(), 0.01);
  }
}

TEST(PoseGraphTest, PriorsPinTheFrame) {
  Loop loop(5);
  const Pose2 elsewhere(-3.0, 4.0, -1.0);
  loop.graph.fixed.clear();
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    loop.graph.priors.push_back({static_cast<int>(i), elsewhere * loop.truth[i], 1e-4 * Eigen::Matrix3d::Identity()});
    loop.graph.map_from_base[i] = elsewhere * loop.graph.map_from_base[i];
  }
  OptimizePoses(&loop.graph);
  for (std::size_t i = 0; i < loop.truth.size(); ++i) {
    EXPECT_LT((loop.graph.map_from_base[i].translation() - (elsewhere * loop.truth[i]).translation()).norm(), 5e-3);
  }
}

TEST(PoseGraphTest, LinkResidualIsInSigmas) {
  Link link;
  link.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-4).asDiagonal();
  EXPECT_NEAR(LinkResidual(link, Pose2(), Pose2(3e-3, 4e-3, 0.0)), 5.0, 1e-9);
  EXPECT_NEAR(LinkResidual(link, Pose2(1.0, 1.0, 3.1), Pose2(1.0, 1.0, 3.1 + 0.02)), 2.0, 1e-6);
  link.first_from_second = Pose2(0.0, 0.0, std::numbers::pi);
  EXPECT_NEAR(LinkResidual(link, Pose2(), Pose2(0.0, 0.0, -std::numbers::pi + 0.01)), 1.0, 1e-6);
}

TEST(PoseGraphTest, NothingMeasuredNothingMoves) {
  PoseGraph graph;
  graph.map_from_base = {Pose2(1.0, 2.0, 3.0)};
  EXPECT_TRUE(OptimizePoses(&graph).converged);
  EXPECT_EQ(graph.map_from_base[0].x(), 1.0);
}

Link MakeLink(int first, int second, const Pose2& motion, int inliers) {
  Link link;
  link.first = first;
  link.second = second;
  link.first_from_second = motion;
  link.inliers = inliers;
  return link;
}

TEST(SpanningForestTest, ComponentsAreNumberedByTheirSmallestFrame) {
  const std::vector<Link> links = {MakeLink(1, 4, {}, 1), MakeLink(4, 6, {}, 1), MakeLink(0, 3, {}, 1)};
  EXPECT_EQ(FindComponents(7, links), (std::vector<int>{0, 1, 2, 0, 1, 3, 1}));
  EXPECT_EQ(FindComponents(3, {}), (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(FindComponents(0, {}).empty());
}

TEST(SpanningForestTest, ChainsTheStrongestLinks) {
  const Pose2 step(1.0, 0.0, 0.0);
  const Pose2 weak(9.0, 9.0, 9.0);
  // 0 - 1 - 2 are chained by strong links, not by the weak link 0 - 2 or the odometry 1 - 2; only odometry reaches 3.
  const std::vector<Link> links = {MakeLink(0, 2, weak, 10), MakeLink(0, 1, step, 50), MakeLink(2, 1, step, 40)};
  const std::vector<Link> odometry = {MakeLink(1, 2, weak, 0), MakeLink(2, 3, Pose2(0.0, 1.0, 0.0), 0)};
  const Pose2 root(5.0, 5.0, 0.5 * std::numbers::pi);
  const std::vector<Pose2> poses = ChainPoses({root, root, root, root, Pose2(7.0, 7.0, 0.0)}, links, odometry);
  const auto expect_at = [&](std::size_t i, double x, double y) {
    EXPECT_NEAR(poses[i].x(), x, 1e-12) << i;
    EXPECT_NEAR(poses[i].y(), y, 1e-12) << i;
  };
  expect_at(0, 5.0, 5.0);
  expect_at(1, 5.0, 6.0);
  expect_at(2, 5.0, 5.0);  // link 2 - 1 is inverted
  expect_at(3, 4.0, 5.0);
  expect_at(4, 7.0, 7.0);  // not connected
}

}  // namespace
}  // namespace floorloc
