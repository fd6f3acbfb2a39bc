// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/monocular_odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/synthetic/corridor.h"

namespace floorloc {
namespace {

constexpr std::int64_t kStepNs = 100'000'000;

const Corridor& TheCorridor() {
  static const Corridor corridor(Corridor::MakeCamera());
  return corridor;
}

Eigen::Isometry3d PoseAt(const Eigen::Vector3d& position, double yaw_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(position);
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()));
  return pose;
}

// A slight S-curve along the corridor.
std::vector<Eigen::Isometry3d> Walk(int frames, double step_m) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < frames; ++i) {
    const double z = step_m * i;
    poses.push_back(PoseAt({0.4 * std::sin(0.9 * z), 0.05 * std::sin(2.0 * z), z}, 0.25 * std::cos(0.9 * z)));
  }
  return poses;
}

double Angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.rotation().transpose() * b.rotation()).angle();
}

using Results = std::vector<MonocularOdometryResult>;

Results TrackAll(const std::vector<Eigen::Isometry3d>& poses, const MonocularOdometryOptions& options,
                 bool with_positions = false) {
  MonocularOdometry odometry(Corridor::MakeCamera(), options);
  Results results;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto position = with_positions ? std::optional<Eigen::Vector3d>(poses[i].translation()) : std::nullopt;
    results.push_back(odometry.Track(static_cast<std::int64_t>(i) * kStepNs,
                                     TheCorridor().View(poses[i], static_cast<int>(i)), position));
  }
  return results;
}

// From the first keyframe with nonzero baseline on, every pose equals the truth up to one scale.
void ExpectSameUpToScale(const Results& results, const std::vector<Eigen::Isometry3d>& poses) {
  const Eigen::Vector3d whole = (poses.front().inverse() * poses.back()).translation();
  const double scale = whole.norm() / results.back().world_from_camera.translation().norm();
  bool begun = false;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    begun = begun || results[i].new_keyframe;
    const Eigen::Isometry3d truth = poses[0].inverse() * poses[i];
    EXPECT_LT(Angle(truth, results[i].world_from_camera), 0.04) << i;
    if (begun) {
      EXPECT_EQ(results[i].status, MonocularStatus::kTracked) << i;
      EXPECT_LT((scale * results[i].world_from_camera.translation() - truth.translation()).norm(), 0.04 * whole.norm())
          << i;
    }
  }
  EXPECT_TRUE(begun);
  EXPECT_EQ(results.back().scale_breaks, 0);
}

class DetectorTest : public ::testing::TestWithParam<PointDetector> {};
INSTANTIATE_TEST_SUITE_P(Points, DetectorTest,
                         ::testing::Values(PointDetector::kOrb, PointDetector::kBrisk, PointDetector::kAkaze),
                         [](const auto& test) { return ToString(test.param); });

TEST_P(DetectorTest, FollowsACorridorUpToScale) {
  const std::vector<Eigen::Isometry3d> poses = Walk(45, 0.08);
  MonocularOdometryOptions options;
  options.tracker.detector = GetParam();
  const Results results = TrackAll(poses, options);
  ExpectSameUpToScale(results, poses);
  int keyframes = 0;
  for (const MonocularOdometryResult& result : results) {
    keyframes += result.new_keyframe ? 1 : 0;
  }
  EXPECT_GE(keyframes, 4) << "the scale was handed on";
}

TEST(MonocularOdometryTest, PositionsFromElsewhereGiveMetres) {
  const std::vector<Eigen::Isometry3d> poses = Walk(40, 0.08);
  const Results results = TrackAll(poses, {}, true);
  const Eigen::Vector3d end = (poses.front().inverse() * poses.back()).translation();
  EXPECT_LT((results.back().world_from_camera.translation() - end).norm(), 0.02 * end.norm());
}

TEST(MonocularOdometryTest, StandstillGivesNoTranslation) {
  std::vector<Eigen::Isometry3d> poses(15, PoseAt({0.0, 0.0, 0.0}, 0.0));
  for (const MonocularOdometryResult& result : TrackAll(poses, {})) {
    EXPECT_NE(result.status, MonocularStatus::kTracked);
    EXPECT_EQ(result.world_from_camera.translation().norm(), 0.0);
    EXPECT_LT(Angle(result.world_from_camera, Eigen::Isometry3d::Identity()), 0.003);
  }
  poses = Walk(25, 0.1);
  poses.insert(poses.end(), 15, poses.back());
  const Results results = TrackAll(poses, {});
  const Eigen::Vector3d stop = results[24].world_from_camera.translation();
  for (std::size_t i = 25; i < results.size(); ++i) {
    EXPECT_LT((results[i].world_from_camera.translation() - stop).norm(), 0.02 * stop.norm()) << i;
  }
}

TEST(MonocularOdometryTest, TurningOnTheSpotIsARotation) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 20; ++i) {
    poses.push_back(PoseAt({0.0, 0.0, 0.0}, 0.02 * i));
  }
  const Results results = TrackAll(poses, {});
  for (std::size_t i = 1; i < poses.size(); ++i) {
    EXPECT_EQ(results[i].status, MonocularStatus::kRotated) << i;
    EXPECT_EQ(results[i].world_from_camera.translation().norm(), 0.0) << i;
    EXPECT_LT(Angle(results[i].world_from_camera, poses[i]), 0.005) << i;
  }
}

TEST(MonocularOdometryTest, GoesOnAfterALossAndCountsTheScaleThatWasLost) {
  std::vector<Eigen::Isometry3d> poses = Walk(25, 0.1);
  MonocularOdometry odometry(Corridor::MakeCamera(), {});
  MonocularOdometryResult result;
  std::int64_t stamp = 0;
  for (std::size_t i = 0; i < poses.size(); ++i, stamp += kStepNs) {
    result = odometry.Track(stamp, TheCorridor().View(poses[i], 0));
  }
  const Eigen::Isometry3d before = result.world_from_camera;
  const cv::Mat black(300, 400, CV_8UC1, cv::Scalar(3));
  result = odometry.Track(stamp, black);
  EXPECT_EQ(result.status, MonocularStatus::kLost);
  EXPECT_LT((result.world_from_camera.translation() - before.translation()).norm(), 1e-9);
  for (const Eigen::Isometry3d& pose : poses) {
    result = odometry.Track(stamp += kStepNs, TheCorridor().View(pose, 0));
  }
  EXPECT_EQ(result.status, MonocularStatus::kTracked);
  EXPECT_EQ(result.scale_breaks, 1);
}

TEST(MonocularOdometryTest, LeavesOutARimThatMovesWithTheCamera) {
  constexpr int kRim = 50;
  cv::Mat rim(300, 400, CV_8UC1);
  cv::RNG random(3);
  random.fill(rim, cv::RNG::UNIFORM, 0, 255);
  const std::vector<Eigen::Isometry3d> poses = Walk(30, 0.08);
  MonocularOdometryOptions options;
  options.tracker.border_px = kRim;
  MonocularOdometry odometry(Corridor::MakeCamera(), options);
  Results results;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    cv::Mat framed = rim.clone();
    const cv::Rect inside(kRim, kRim, 400 - 2 * kRim, 300 - 2 * kRim);
    TheCorridor().View(poses[i], static_cast<int>(i))(inside).copyTo(framed(inside));
    results.push_back(odometry.Track(static_cast<std::int64_t>(i) * kStepNs, framed));
  }
  ExpectSameUpToScale(results, poses);
}

TEST(MonocularOdometryTest, RefusesBadInput) {
  MonocularOdometry odometry(Corridor::MakeCamera(), {});
  const cv::Mat view(300, 400, CV_8UC1, cv::Scalar(0));
  odometry.Track(kStepNs, view);
  EXPECT_THROW(odometry.Track(kStepNs, view), std::invalid_argument);
  EXPECT_THROW(odometry.Track(2 * kStepNs, view.colRange(0, 300)), std::invalid_argument);
  EXPECT_EQ(odometry.Track(2 * kStepNs, view).status, MonocularStatus::kLost);
  MonocularOdometryOptions options;
  options.noise_px = 0.0;
  EXPECT_THROW(MonocularOdometry(Corridor::MakeCamera(), options), std::invalid_argument);
  EXPECT_THROW(ParsePointDetector("sift"), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
