// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/two_view.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

constexpr double kNoise = 1e-3;

// Points in front of two cameras and their noisy projections, of which `wrong` are outliers.
struct Scene {
  Scene(const Eigen::Isometry3d& second_from_first, int count, int wrong) : motion(second_from_first) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::normal_distribution<double> noise(0.0, kNoise);
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d point(3.0 * unit(random), 2.0 * unit(random), 5.0 + 2.0 * unit(random));
      const Eigen::Vector3d in_second = second_from_first * point;
      const Eigen::Vector2d error(noise(random), noise(random));
      const Eigen::Vector2d seen =
          i < wrong ? Eigen::Vector2d(unit(random), unit(random)) : Eigen::Vector2d(in_second.hnormalized() + error);
      points.push_back(point);
      pairs.push_back({point.hnormalized(), seen});
    }
  }

  Eigen::Isometry3d motion;
  std::vector<Eigen::Vector3d> points;
  std::vector<PointPair> pairs;
};

Eigen::Isometry3d Motion(const Eigen::Vector3d& shift, double turn_rad) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(shift);
  motion.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(0.3, 1.0, -0.2).normalized()));
  return motion;
}

double Angle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle();
}

TEST(TwoViewTest, ARotationLeavesNoParallax) {
  const Scene scene(Motion(Eigen::Vector3d::Zero(), 0.2), 100, 30);
  const RotationFit fit = FitRotation(scene.pairs);
  EXPECT_LT(Angle(fit.second_from_first, scene.motion.rotation()), 2e-3);
  EXPECT_LT(fit.parallax_rad, 5.0 * kNoise);
}

TEST(TwoViewTest, AShiftLeavesParallax) {
  const Scene scene(Motion({0.6, 0.0, 0.3}, 0.1), 100, 0);
  EXPECT_GT(FitRotation(scene.pairs).parallax_rad, 10.0 * kNoise);
}

TEST(TwoViewTest, FindsTheMotionAmongWrongPairs) {
  const Scene scene(Motion({0.5, -0.2, 0.4}, 0.15), 150, 50);
  const auto motion = EstimateMotion(scene.pairs, 2.0 * kNoise);
  ASSERT_TRUE(motion);
  EXPECT_LT(Angle(motion->second_from_first, scene.motion.rotation()), 0.02);
  EXPECT_GT(motion->direction.dot(scene.motion.translation().normalized()), 0.995);
  EXPECT_GE(motion->inlier_count, 80);
  EXPECT_LE(motion->inlier_count, 110);
}

TEST(TwoViewTest, FewPairsGiveNoMotion) {
  const Scene scene(Motion({0.5, 0.0, 0.0}, 0.0), 6, 0);
  EXPECT_FALSE(EstimateMotion(scene.pairs, kNoise));
}

TEST(TwoViewTest, TriangulatesDepths) {
  const Scene scene(Motion({0.8, 0.1, -0.2}, 0.1), 60, 0);
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    const auto depth = TriangulateDepth(scene.pairs[i], scene.motion, 0.01);
    ASSERT_TRUE(depth) << i;
    EXPECT_NEAR(*depth, scene.points[i].z(), 0.1 * scene.points[i].z()) << i;
  }
  EXPECT_FALSE(TriangulateDepth({{0.1, 0.1}, {0.1, 0.1}}, Motion({0.5, 0.0, 0.0}, 0.0), 0.01)) << "parallel rays";
  EXPECT_FALSE(TriangulateDepth({{0.0, 0.0}, {0.2, 0.0}}, Motion({-0.5, 0.0, 0.0}, 0.0), 0.01)) << "behind";
}

TEST(TwoViewTest, LandmarksFixThePose) {
  const Scene scene(Motion({0.3, -0.1, 0.2}, 0.1), 80, 15);
  std::vector<LandmarkObservation> landmarks;
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    landmarks.push_back({scene.points[i], scene.pairs[i].second});
  }
  const auto pose = RefinePoseByLandmarks(landmarks, Eigen::Isometry3d::Identity(), kNoise, 0.5);
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation() - scene.motion.translation()).norm(), 0.01);
  EXPECT_LT(Angle(pose->rotation(), scene.motion.rotation()), 2e-3);
  EXPECT_FALSE(RefinePoseByLandmarks(landmarks, Eigen::Isometry3d::Identity(), kNoise, 0.95)) << "too many are wrong";
}

}  // namespace
}  // namespace floorloc
