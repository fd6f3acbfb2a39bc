// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>
#include <thread>

#include "core/map/map_database.h"
#include "mapbuilder/build_map.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxErrorM = 2e-3;
constexpr double kMaxErrorRad = 0.2 * kPi / 180.0;

const SyntheticFloor& Floor() {
  static const SyntheticFloor floor(1);
  return floor;
}

// The map of the synthetic floor, in the floor's own frame.
FloorMap BuildFloorMap() {
  const TemporaryFolder folder;
  Floor().WriteSurvey(folder.path() / "survey");
  BuildOptions options;
  options.surveys = {folder.path() / "survey"};
  options.out = folder.path() / "floor.floormap";
  options.poses = ReadTum(folder.path() / "survey" / "groundtruth.tum");
  options.mosaic.resolution_m = 0.0028;  // coarse is fast
  options.placement.prior_sigma_m = 1e-3;
  options.placement.prior_sigma_rad = 1e-3;
  BuildMap(options);
  return MapDatabase(options.out).ReadMap();
}

const FloorMap& TheMap() {
  static const FloorMap map = BuildFloorMap();
  return map;
}

cv::Mat GrayView(const SyntheticFloor& floor, const Pose2& map_from_base, std::uint64_t noise_seed) {
  RenderConditions conditions;
  conditions.read_noise = 2.0;
  conditions.gain = 1.1;
  conditions.noise_seed = noise_seed;
  cv::Mat gray;
  cv::cvtColor(floor.View(map_from_base, conditions), gray, cv::COLOR_BGR2GRAY);
  return gray;
}

std::vector<Pose2> RandomPoses(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Pose2> poses;
  for (int i = 0; i < count; ++i) {
    const double x = 0.3 + 0.6 * unit(random);
    const double y = 0.3 + 0.3 * unit(random);
    poses.push_back(Floor().BaseForView(x, y, kPi * (2.0 * unit(random) - 1.0)));
  }
  return poses;
}

// Error where the frame looks, not at the base 0.2 m behind it.
void ExpectNear(const LocalizationResult& result, const Pose2& truth) {
  ASSERT_EQ(result.status, LocalizationStatus::kLocalized) << truth << " " << ToString(result.reason);
  EXPECT_EQ(result.reason, NotLocalizedReason::kNone);
  const Eigen::Vector2d center = Floor().camera().floor.roi.Center();
  EXPECT_LT((result.map_from_base * center - truth * center).norm(), kMaxErrorM) << truth;
  EXPECT_LT((result.map_from_base.translation() - truth.translation()).norm(), kMaxErrorM) << truth;
  EXPECT_LT(std::abs(WrapAngle(result.map_from_base.yaw() - truth.yaw())), kMaxErrorRad) << truth;
}

class LocalizerTest : public ::testing::Test {
 protected:
  static const Localizer& TheLocalizer() {
    static const Localizer localizer(TheMap(), LocalizerOptions{});
    return localizer;
  }
  LocalizationResult Localize(const cv::Mat& gray, const std::optional<PosePrior>& prior = std::nullopt) const {
    return TheLocalizer().Localize(rectifier_, gray, prior);
  }

  Rectifier rectifier_{Floor().camera()};
};

TEST_F(LocalizerTest, FindsAnyViewOnTheWholeMap) {
  for (const Pose2& truth : RandomPoses(40, 1)) {
    const LocalizationResult result = Localize(GrayView(Floor(), truth, 1));
    ExpectNear(result, truth);
    EXPECT_FALSE(result.used_prior);
    EXPECT_LT(result.p_wrong, 1e-4);
    EXPECT_GE(result.inliers, 20);
  }
}

TEST_F(LocalizerTest, FindsAnyViewNearAPrior) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const Pose2& truth : RandomPoses(40, 2)) {
    PosePrior prior;
    prior.map_from_base = truth * Pose2(0.1 * unit(random), 0.1 * unit(random), 0.15 * unit(random));
    const LocalizationResult result = Localize(GrayView(Floor(), truth, 2), prior);
    ExpectNear(result, truth);
    EXPECT_TRUE(result.used_prior);
  }
}

TEST_F(LocalizerTest, CovarianceIsFiniteAndPositive) {
  for (const Pose2& truth : RandomPoses(10, 3)) {
    const LocalizationResult result = Localize(GrayView(Floor(), truth, 3));
    ASSERT_EQ(result.status, LocalizationStatus::kLocalized);
    ASSERT_TRUE(result.covariance.allFinite());
    EXPECT_LT((result.covariance - result.covariance.transpose()).norm(), 1e-12);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(result.covariance);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.0);
    EXPECT_LT(std::sqrt(result.covariance(0, 0)), 5e-3);
    EXPECT_LT(std::sqrt(result.covariance(2, 2)), 1e-2);
  }
}

TEST_F(LocalizerTest, AnotherFloorIsNotThisFloor) {
  const SyntheticFloor other(77);
  for (const Pose2& pose : RandomPoses(20, 4)) {
    const cv::Mat view = GrayView(other, pose, 4);
    EXPECT_NE(Localize(view).status, LocalizationStatus::kLocalized) << pose;
    EXPECT_NE(Localize(view, PosePrior{pose}).status, LocalizationStatus::kLocalized) << pose;
  }
}

TEST_F(LocalizerTest, ABlackPictureHasTooFewKeypoints) {
  const LocalizationResult result = Localize(cv::Mat::zeros(480, 640, CV_8UC1));
  EXPECT_EQ(result.status, LocalizationStatus::kNotLocalized);
  EXPECT_EQ(result.reason, NotLocalizedReason::kTooFewKeypoints);
  EXPECT_EQ(result.keypoints, 0);
}

TEST_F(LocalizerTest, AWrongPriorFindsNothing) {
  const Pose2 truth = Floor().BaseForView(0.4, 0.4, 0.3);
  const cv::Mat view = GrayView(Floor(), truth, 5);
  ExpectNear(Localize(view, PosePrior{truth}), truth);
  EXPECT_EQ(Localize(view, PosePrior{Pose2(5.0, 5.0, 0.0)}).status, LocalizationStatus::kNotLocalized);
  EXPECT_EQ(Localize(view, PosePrior{truth * Pose2(0.0, 0.0, kPi)}).status, LocalizationStatus::kNotLocalized);
  for (const double wild : {1e300, -1e15, std::nan("")}) {
    EXPECT_EQ(Localize(view, PosePrior{Pose2(wild, 0.0, 0.0)}).status, LocalizationStatus::kNotLocalized) << wild;
  }
}

TEST_F(LocalizerTest, PictureOfAnotherSizeIsRefused) {
  EXPECT_THROW(Localize(cv::Mat::zeros(479, 640, CV_8UC1)), std::invalid_argument);
}

void ExpectSame(const LocalizationResult& a, const LocalizationResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.map_from_base.x(), b.map_from_base.x());
  EXPECT_EQ(a.map_from_base.y(), b.map_from_base.y());
  EXPECT_EQ(a.map_from_base.yaw(), b.map_from_base.yaw());
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.p_wrong, b.p_wrong);
}

TEST_F(LocalizerTest, SameInputSameAnswer) {
  const cv::Mat view = GrayView(Floor(), Floor().BaseForView(0.5, 0.4, -2.0), 6);
  const Localizer another(TheMap(), LocalizerOptions{});
  ExpectSame(Localize(view), Localize(view));
  ExpectSame(Localize(view), another.Localize(rectifier_, view, std::nullopt));
}

TEST_F(LocalizerTest, EveryThreadGetsTheAnswerOfOne) {
  const std::vector<Pose2> poses = RandomPoses(8, 7);
  std::vector<cv::Mat> views;
  std::vector<LocalizationResult> alone;
  for (const Pose2& pose : poses) {
    views.push_back(GrayView(Floor(), pose, 7));
    alone.push_back(Localize(views.back()));
  }
  std::vector<LocalizationResult> together(poses.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      threads.emplace_back([&, i] { together[i] = Localize(views[i]); });
    }
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ExpectSame(together[i], alone[i]);
  }
}

TEST_F(LocalizerTest, EveryMatcherFindsTheView) {
  const Pose2 truth = Floor().BaseForView(0.6, 0.45, 2.5);
  const cv::Mat view = GrayView(Floor(), truth, 8);
  for (const MatcherType type : {MatcherType::kBruteForce, MatcherType::kHash, MatcherType::kFlann}) {
    LocalizerOptions options;
    options.index.type = type;
    ExpectNear(Localizer(TheMap(), options).Localize(rectifier_, view, std::nullopt), truth);
  }
}

TEST_F(LocalizerTest, AnEmptyMapLocalizesNothing) {
  FloorMap empty = TheMap();
  empty.keypoints.keypoints.clear();
  empty.keypoints.observations.clear();
  empty.keypoints.descriptors = cv::Mat(0, TheMap().keypoints.descriptors.cols, CV_8U);
  const Localizer localizer(empty, LocalizerOptions{});
  const Pose2 pose = Floor().BaseForView(0.6, 0.45, 0.0);
  const cv::Mat view = GrayView(Floor(), pose, 9);
  EXPECT_EQ(localizer.Localize(rectifier_, view, std::nullopt).status, LocalizationStatus::kNotLocalized);
  EXPECT_EQ(localizer.Localize(rectifier_, view, PosePrior{pose}).status, LocalizationStatus::kNotLocalized);
}

TEST_F(LocalizerTest, RefusesBadOptions) {
  LocalizerOptions options;
  options.max_ratio_binary = 1.5F;
  EXPECT_THROW(Localizer(TheMap(), options), std::invalid_argument);
  options = {};
  options.registration.min_inliers = 0;
  EXPECT_THROW(Localizer(TheMap(), options), std::invalid_argument);
}

TEST(LocalizationNamesTest, AreTheContracts) {
  EXPECT_STREQ(ToString(LocalizationStatus::kLocalized), "localized");
  EXPECT_STREQ(ToString(LocalizationStatus::kAmbiguous), "ambiguous");
  EXPECT_STREQ(ToString(LocalizationStatus::kNotLocalized), "not_localized");
  EXPECT_STREQ(ToString(NotLocalizedReason::kTooFewKeypoints), "too_few_keypoints");
}

}  // namespace
}  // namespace floorloc
