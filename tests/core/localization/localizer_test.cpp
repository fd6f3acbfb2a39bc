// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>
#include <thread>

#include "core/localization/moving_frame.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
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

// The map file of the synthetic floor, in the floor's own frame.
class FloorMapFile {
 public:
  explicit FloorMapFile(double mosaic_resolution_m) {
    Floor().WriteSurvey(folder_.path() / "survey");
    BuildOptions options;
    options.surveys = {folder_.path() / "survey"};
    options.out = folder_.path() / "floor.floormap";
    options.poses = ReadTum(folder_.path() / "survey" / "groundtruth.tum");
    options.mosaic.resolution_m = mosaic_resolution_m;
    options.placement.prior_sigma_m = 1e-3;
    options.placement.prior_sigma_rad = 1e-3;
    BuildMap(options);
    database_ = std::make_unique<MapDatabase>(options.out);
  }
  FloorMap Read() const { return database_->ReadMap(); }
  MosaicTileSource Tiles() const {
    return [this](const TileId& tile) { return database_->ReadMosaicTile(tile); };
  }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<MapDatabase> database_;
};

const FloorMapFile& TheFile() {
  static const FloorMapFile file(Floor().camera().floor.resolution_m);
  return file;
}

const FloorMap& TheMap() {
  static const FloorMap map = TheFile().Read();
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

// Error at the centre of the image, not at the base 0.2 m behind it.
void ExpectNear(const LocalizationResult& result, const Pose2& truth) {
  ASSERT_EQ(result.status, LocalizationStatus::kLocalized) << truth << " " << ToString(result.reason);
  EXPECT_EQ(result.reason, NotLocalizedReason::kNone);
  const Eigen::Vector2d center = Floor().camera().floor.roi.Center();
  EXPECT_LT((result.map_from_base * center - truth * center).norm(), kMaxErrorM) << truth;
  EXPECT_LT((result.map_from_base.translation() - truth.translation()).norm(), kMaxErrorM) << truth;
  EXPECT_LT(std::abs(WrapAngle(result.map_from_base.yaw() - truth.yaw())), kMaxErrorRad) << truth;
}

// All tests run with and without the mosaic.
class LocalizerTest : public ::testing::TestWithParam<bool> {
 protected:
  static MosaicTileSource Tiles() { return GetParam() ? TheFile().Tiles() : nullptr; }
  static const Localizer& TheLocalizer() {
    static const Localizer by_keypoints(TheMap(), LocalizerOptions{});
    static const Localizer by_mosaic(TheMap(), LocalizerOptions{}, TheFile().Tiles());
    return GetParam() ? by_mosaic : by_keypoints;
  }
  LocalizationResult Localize(const cv::Mat& gray, const std::optional<PosePrior>& prior = std::nullopt) const {
    return TheLocalizer().Localize(rectifier_, gray, prior);
  }

  Rectifier rectifier_{Floor().camera()};
};
INSTANTIATE_TEST_SUITE_P(Mosaic, LocalizerTest, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "WithMosaic" : "KeypointsOnly"; });

TEST_P(LocalizerTest, FindsAnyViewOnTheWholeMap) {
  for (const Pose2& truth : RandomPoses(40, 1)) {
    const LocalizationResult result = Localize(GrayView(Floor(), truth, 1));
    ExpectNear(result, truth);
    EXPECT_FALSE(result.used_prior);
    EXPECT_LT(result.p_wrong, 1e-4);
    EXPECT_GE(result.inliers, 20);
  }
}

// Adds a copy of the map's floor, shifted by shift_m, with slightly changed descriptors.
FloorMap WithNearDuplicate(FloorMap map, double shift_m) {
  std::mt19937 random(3);
  const std::size_t count = map.keypoints.size();
  for (std::size_t i = 0; i < count; ++i) {
    Keypoint k = map.keypoints.keypoints[i];
    k.x_m += static_cast<float>(shift_m);
    map.keypoints.keypoints.push_back(k);
    map.keypoints.observations.push_back(map.keypoints.observations[i]);
  }
  for (cv::Mat* descriptors : {&map.keypoints.descriptors, &map.keypoints.upright}) {
    cv::Mat duplicates = descriptors->clone();
    for (int row = 0; row < duplicates.rows; ++row) {
      for (int flip = 0; flip < 10; ++flip) {
        duplicates.at<std::uint8_t>(row, static_cast<int>(random() % static_cast<unsigned>(duplicates.cols))) ^=
            static_cast<std::uint8_t>(1U << (random() % 8));
      }
    }
    descriptors->push_back(duplicates);
  }
  return map;
}

TEST(RepeatingFloorTest, AWrongPriorIsNotConfirmedByAliasedFloor) {
  constexpr double kShiftM = 3.0;
  const Localizer localizer(WithNearDuplicate(TheMap(), kShiftM), LocalizerOptions{});
  const Rectifier rectifier(Floor().camera());
  for (const Pose2& truth : RandomPoses(10, 9)) {
    const cv::Mat view = GrayView(Floor(), truth, 9);
    PosePrior prior;
    prior.map_from_base = truth;
    ExpectNear(localizer.Localize(rectifier, view, prior), truth);
    prior.map_from_base = Pose2(truth.x() + kShiftM, truth.y(), truth.yaw());
    const LocalizationResult misled = localizer.Localize(rectifier, view, prior);
    EXPECT_EQ(misled.status, LocalizationStatus::kNotLocalized);
    EXPECT_EQ(misled.reason, NotLocalizedReason::kContradictsPrior);
  }
}

TEST(RepeatingFloorTest, TheCopyCompetesWithWhereTheFrameIs) {
  constexpr double kShiftM = 3.0;
  const Localizer localizer(WithNearDuplicate(TheMap(), kShiftM), LocalizerOptions{});
  const Rectifier rectifier(Floor().camera());
  const Pose2 truth = RandomPoses(1, 9).front();
  const FrameObservation frame = localizer.Observe(rectifier, GrayView(Floor(), truth, 9));
  const LocalizationResult result = localizer.Localize(frame, PosePrior{truth});
  const std::vector<CompetingPose> poses = localizer.Compete(frame, result, 2);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].map_from_base.translation(), result.map_from_base.translation());
  EXPECT_NEAR(poses[1].map_from_base.x(), truth.x() + kShiftM, kMaxErrorM);
  for (const CompetingPose& pose : poses) {
    EXPECT_GE(pose.inliers, 20);
    EXPECT_EQ(std::count_if(pose.matches.begin(), pose.matches.end(), [](const PointMatch& m) { return m.inlier; }),
              pose.inliers);
    for (const PointMatch& match : pose.matches) {
      const double apart_m = (pose.map_from_base * match.base_m - match.map_m).norm();
      EXPECT_EQ(apart_m <= localizer.options().registration.inlier_radius_m, match.inlier) << apart_m;
    }
  }
  EXPECT_EQ(localizer.Compete(frame, result, 1).size(), 1U);
  const std::vector<CompetingPose> without_result = localizer.Compete(frame, {}, 2);
  ASSERT_FALSE(without_result.empty());
  EXPECT_LT((without_result[0].map_from_base.translation() - truth.translation()).norm(), kMaxErrorM);
}

// The angles of keypoints in blurred or worn images are wrong: where the heading is known they must not matter.
TEST_P(LocalizerTest, ViewsNearAPriorNeedNoAnglesOfKeypoints) {
  const Localizer localizer(TheMap(), LocalizerOptions{}, Tiles());
  std::mt19937 random(12);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  for (const Pose2& truth : RandomPoses(10, 12)) {
    FrameObservation frame = localizer.Observe(rectifier_, GrayView(Floor(), truth, 12));
    for (Keypoint& k : frame.features.keypoints) {
      k.angle_rad = static_cast<float>(kPi) * unit(random);
    }
    cv::randu(frame.features.descriptors, 0, 256);
    PosePrior prior;
    prior.map_from_base = truth * Pose2(0.05, -0.05, 0.1);
    ExpectNear(localizer.Localize(frame, prior), truth);
    ExpectNear(localizer.Localize(frame, std::nullopt), truth);
  }
}

TEST_P(LocalizerTest, AMapWithoutUprightDescriptorsIsUsedAsEver) {
  FloorMap old = TheMap();
  old.keypoints.upright = cv::Mat();
  const Localizer localizer(std::move(old), LocalizerOptions{}, Tiles());
  for (const Pose2& truth : RandomPoses(5, 13)) {
    const cv::Mat view = GrayView(Floor(), truth, 13);
    PosePrior prior;
    prior.map_from_base = truth * Pose2(0.05, 0.05, -0.1);
    ExpectNear(localizer.Localize(rectifier_, view, prior), truth);
    ExpectNear(localizer.Localize(rectifier_, view, std::nullopt), truth);
  }
}

TEST_P(LocalizerTest, FindsAnyViewNearAPrior) {
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

TEST_P(LocalizerTest, CovarianceIsFiniteAndPositive) {
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

TEST_P(LocalizerTest, AnotherFloorIsNotThisFloor) {
  const SyntheticFloor other(77);
  for (const Pose2& pose : RandomPoses(20, 4)) {
    const cv::Mat view = GrayView(other, pose, 4);
    EXPECT_NE(Localize(view).status, LocalizationStatus::kLocalized) << pose;
    EXPECT_NE(Localize(view, PosePrior{pose}).status, LocalizationStatus::kLocalized) << pose;
  }
}

TEST_P(LocalizerTest, ABlackImageShowsNoFloorAndIsNotSearchedFor) {
  for (const std::optional<PosePrior>& prior : {std::optional<PosePrior>(), std::optional(PosePrior{Pose2()})}) {
    const LocalizationResult result = Localize(cv::Mat::zeros(480, 640, CV_8UC1), prior);
    EXPECT_EQ(result.status, LocalizationStatus::kNotLocalized);
    EXPECT_EQ(result.reason, NotLocalizedReason::kNoFloor);
    EXPECT_EQ(result.keypoints, 0);
    EXPECT_EQ(result.timing.match_ms, 0.0);
  }
}

// Stripes: a strong texture that no survey saw, and plenty of keypoints.
cv::Mat Stripes() {
  cv::Mat view(480, 640, CV_8UC1);
  for (int u = 0; u < view.cols; ++u) {
    view.col(u).setTo(u / 6 % 2 == 0 ? 60 : 180);
  }
  cv::Mat noise(view.size(), CV_8UC1);
  cv::RNG(8).fill(noise, cv::RNG::UNIFORM, 0, 40);
  return view + noise;
}

TEST_P(LocalizerTest, AnotherTextureIsRefusedBeforeTheWholeMapIsSearched) {
  const LocalizationResult result = Localize(Stripes());
  EXPECT_EQ(result.reason, NotLocalizedReason::kOtherFloor);
  EXPECT_EQ(result.timing.match_ms, 0.0);
}

TEST_P(LocalizerTest, NearAPriorAnyTextureIsSearchedForAndNamedAfterwards) {
  const LocalizationResult result = Localize(Stripes(), PosePrior{Floor().BaseForView(0.4, 0.4, 0.3)});
  EXPECT_EQ(result.reason, NotLocalizedReason::kOtherFloor);
  EXPECT_GT(result.timing.match_ms, 0.0);
}

TEST_P(LocalizerTest, AWrongPriorFindsNothing) {
  const Pose2 truth = Floor().BaseForView(0.4, 0.4, 0.3);
  const cv::Mat view = GrayView(Floor(), truth, 5);
  ExpectNear(Localize(view, PosePrior{truth}), truth);
  EXPECT_EQ(Localize(view, PosePrior{Pose2(5.0, 5.0, 0.0)}).status, LocalizationStatus::kNotLocalized);
  EXPECT_EQ(Localize(view, PosePrior{truth * Pose2(0.0, 0.0, kPi)}).status, LocalizationStatus::kNotLocalized);
  for (const double wild : {1e300, -1e15, std::nan("")}) {
    EXPECT_EQ(Localize(view, PosePrior{Pose2(wild, 0.0, 0.0)}).status, LocalizationStatus::kNotLocalized) << wild;
  }
}

TEST_P(LocalizerTest, ImageOfAnotherSizeIsRefused) {
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

TEST_P(LocalizerTest, SameInputSameAnswer) {
  const cv::Mat view = GrayView(Floor(), Floor().BaseForView(0.5, 0.4, -2.0), 6);
  const Localizer another(TheMap(), LocalizerOptions{}, Tiles());
  ExpectSame(Localize(view), Localize(view));
  ExpectSame(Localize(view), another.Localize(rectifier_, view, std::nullopt));
}

TEST_P(LocalizerTest, EveryThreadGetsTheAnswerOfOne) {
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

TEST_P(LocalizerTest, EveryMatcherFindsTheView) {
  const Pose2 truth = Floor().BaseForView(0.6, 0.45, 2.5);
  const cv::Mat view = GrayView(Floor(), truth, 8);
  for (const MatcherType type : {MatcherType::kBruteForce, MatcherType::kHash, MatcherType::kFlann}) {
    LocalizerOptions options;
    options.index.type = type;
    ExpectNear(Localizer(TheMap(), options, Tiles()).Localize(rectifier_, view, std::nullopt), truth);
  }
}

TEST_P(LocalizerTest, AnEmptyMapLocalizesNothing) {
  FloorMap empty = TheMap();
  empty.keypoints.keypoints.clear();
  empty.keypoints.observations.clear();
  empty.keypoints.descriptors = cv::Mat(0, TheMap().keypoints.descriptors.cols, CV_8U);
  empty.keypoints.upright = cv::Mat();
  const Localizer localizer(empty, LocalizerOptions{}, Tiles());
  const Pose2 pose = Floor().BaseForView(0.6, 0.45, 0.0);
  const cv::Mat view = GrayView(Floor(), pose, 9);
  EXPECT_EQ(localizer.Localize(rectifier_, view, std::nullopt).status, LocalizationStatus::kNotLocalized);
  EXPECT_EQ(localizer.Localize(rectifier_, view, PosePrior{pose}).status, LocalizationStatus::kNotLocalized);
}

TEST_P(LocalizerTest, RefusesBadOptions) {
  LocalizerOptions options;
  options.max_ratio_binary = 1.5F;
  EXPECT_THROW(Localizer(TheMap(), options, Tiles()), std::invalid_argument);
  options = {};
  options.registration.min_inliers = 0;
  EXPECT_THROW(Localizer(TheMap(), options, Tiles()), std::invalid_argument);
}

// Median error at the image centre over images with the camera vibration of hard conditions.
double MedianErrorWhenShaken(const Localizer& localizer) {
  const Rectifier rectifier(Floor().camera());
  const Eigen::Vector2d center = Floor().camera().floor.roi.Center();
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  std::vector<double> errors;
  for (const Pose2& truth : RandomPoses(21, 31)) {
    RenderConditions conditions;
    conditions.read_noise = 2.0;
    conditions.vibration = {5e-3 * normal(random), 3.5e-3 * normal(random), 2e-3 * normal(random)};
    cv::Mat gray;
    cv::cvtColor(Floor().View(truth, conditions), gray, cv::COLOR_BGR2GRAY);
    const LocalizationResult result = localizer.Localize(rectifier, gray, PosePrior{truth});
    EXPECT_EQ(result.status, LocalizationStatus::kLocalized) << truth;
    errors.push_back((result.map_from_base * center - truth * center).norm());
  }
  std::nth_element(errors.begin(), errors.begin() + 10, errors.end());
  return errors[10];
}

TEST(LocalizerMosaicTest, AbsorbsVibration) {
  const double by_keypoints = MedianErrorWhenShaken(Localizer(TheMap(), LocalizerOptions{}));
  const double by_mosaic = MedianErrorWhenShaken(Localizer(TheMap(), LocalizerOptions{}, TheFile().Tiles()));
  EXPECT_GT(by_keypoints, 1e-3) << "the vibration is strong enough to matter";
  EXPECT_LT(by_mosaic, 0.4 * by_keypoints);
}

TEST(LocalizerMosaicTest, RefinesAStillCamera) {
  const Localizer localizer(TheMap(), LocalizerOptions{}, TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  const Eigen::Vector2d center = Floor().camera().floor.roi.Center();
  for (const Pose2& truth : RandomPoses(10, 32)) {
    const LocalizationResult result = localizer.Localize(rectifier, GrayView(Floor(), truth, 32), std::nullopt);
    ASSERT_EQ(result.status, LocalizationStatus::kLocalized);
    EXPECT_LT((result.map_from_base * center - truth * center).norm(), 7e-4) << truth;
  }
}

TEST(LocalizerMosaicTest, AMosaicThatShowsNothingLeavesThePoseToTheKeypoints) {
  const Localizer by_keypoints(TheMap(), LocalizerOptions{});
  const Rectifier rectifier(Floor().camera());
  const cv::Mat view = GrayView(Floor(), Floor().BaseForView(0.5, 0.4, -2.0), 33);
  const LocalizationResult expected = by_keypoints.Localize(rectifier, view, std::nullopt);
  const std::optional<std::vector<std::uint8_t>> no_image = std::vector<std::uint8_t>(100, 7);
  for (const auto& bytes : {std::optional<std::vector<std::uint8_t>>(), no_image}) {
    const Localizer localizer(TheMap(), LocalizerOptions{}, [&](const TileId&) { return bytes; });
    const LocalizationResult result = localizer.Localize(rectifier, view, std::nullopt);
    ASSERT_EQ(result.status, LocalizationStatus::kLocalized);
    EXPECT_EQ(result.map_from_base.Between(expected.map_from_base).Log().norm(), 0.0);
    EXPECT_EQ(result.covariance, expected.covariance);
  }
}

TEST(LocalizerMosaicTest, AMosaicCoarserThanTheFramesDoesNoHarm) {
  const FloorMapFile coarse(8.0 * Floor().camera().floor.resolution_m);
  const Localizer localizer(coarse.Read(), LocalizerOptions{}, coarse.Tiles());
  const Rectifier rectifier(Floor().camera());
  for (const Pose2& truth : RandomPoses(10, 34)) {
    ExpectNear(localizer.Localize(rectifier, GrayView(Floor(), truth, 34), std::nullopt), truth);
  }
}

// Looks at views in part that are usually looked at as a whole.
LocalizerOptions InPart() {
  LocalizerOptions options;
  options.partial_view = {.max_views = 0.5, .keypoint_views = 0.4, .outer_cells = 40};
  return options;
}

TEST(LocalizerBlurTest, AFastRobotIsFoundByTheDirectionOfItsBlur) {
  const Localizer localizer(TheMap(), {}, TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  for (const Pose2& truth : RandomPoses(4, 19)) {
    RenderConditions conditions;
    conditions.motion = {0.013, 0.004, 0.0};
    conditions.read_noise = 2.0;
    cv::Mat gray;
    cv::cvtColor(Floor().View(truth, conditions), gray, cv::COLOR_BGR2GRAY);
    const PosePrior prior{truth, 0.05, 0.05};
    FrameHints hints{.prior = prior, .anywhere = false};
    const LocalizationResult without = ObserveAndLocalize(localizer, rectifier, gray, hints).result;
    hints.motion.twist = Eigen::Vector3d(2.6, 0.8, 0.0);
    FloorCamera global_shutter = Floor().camera();
    global_shutter.camera.readout.seconds = 0.0;
    const ObservedFrame found = ObserveAndLocalize(localizer, Rectifier(global_shutter), gray, hints);
    ExpectNear(found.result, truth);
    EXPECT_GT(found.result.inliers, 2 * without.inliers);
  }
}

TEST(LocalizerPartTest, APartOfTheViewSuffices) {
  const Localizer whole(TheMap(), LocalizerOptions{}, TheFile().Tiles());
  const Localizer part(TheMap(), InPart(), TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  for (const Pose2& truth : RandomPoses(10, 35)) {
    const cv::Mat view = GrayView(Floor(), truth, 35);
    const ObservedFrame located = ObserveAndLocalize(part, rectifier, view, {});
    ExpectNear(located.result, truth);
    const RectM& all = ObserveAndLocalize(whole, rectifier, view, {}).observation.roi;
    EXPECT_LT(located.observation.roi.width_m(), 0.8 * all.width_m());
    for (const Keypoint& keypoint : located.observation.features.keypoints) {
      EXPECT_TRUE(located.observation.roi.Contains(keypoint.Position().cast<double>()));
    }
  }
}

TEST(LocalizerPartTest, WhereThePartDoesNotSufficeTheWholeViewIsSearched) {
  const Localizer whole(TheMap(), LocalizerOptions{}, TheFile().Tiles());
  const Localizer part(TheMap(), InPart(), TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  cv::Mat view = GrayView(Floor(), RandomPoses(1, 36)[0], 36);
  const cv::Rect middle(view.cols * 15 / 100, view.rows * 15 / 100, view.cols * 7 / 10, view.rows * 7 / 10);
  view(middle).setTo(100);  // a sheet of paper
  const LocalizationResult expected = whole.Localize(rectifier, view, std::nullopt);
  const LocalizationResult found = part.Localize(rectifier, view, std::nullopt);
  ASSERT_EQ(expected.status, LocalizationStatus::kLocalized);
  EXPECT_EQ(found.status, LocalizationStatus::kLocalized);
  EXPECT_EQ(found.map_from_base.Between(expected.map_from_base).Log().norm(), 0.0);
  EXPECT_GT(found.timing.total_ms, found.timing.rectify_ms);
}

TEST(LocalizerCompressionTest, AQualityThatIsGoodEnoughChangesNothing) {
  const Localizer localizer(TheMap(), LocalizerOptions{}, TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  const cv::Mat blank(Floor().camera().camera.height_px, Floor().camera().camera.width_px, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(ObserveAndLocalize(localizer, rectifier, blank, {.jpeg_quality = 40}).result.poor_jpeg_quality,
            std::nullopt);
  EXPECT_EQ(ObserveAndLocalize(localizer, rectifier, blank, {.jpeg_quality = 39}).result.poor_jpeg_quality, 39);
  EXPECT_EQ(ObserveAndLocalize(localizer, rectifier, blank, {}).result.poor_jpeg_quality, std::nullopt);
}

// Number of views that are found after they were compressed to the quality, which the localizer is told or not.
int FoundAt(int jpeg_quality, bool told) {
  static const Localizer localizer(TheMap(), LocalizerOptions{}, TheFile().Tiles());
  const Rectifier rectifier(Floor().camera());
  int found = 0;
  for (const Pose2& truth : RandomPoses(12, 37)) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", GrayView(Floor(), truth, 37), bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality});
    const cv::Mat view = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    const LocalizationResult result =
        ObserveAndLocalize(localizer, rectifier, view,
                           {.jpeg_quality = told ? std::optional(jpeg_quality) : std::nullopt})
            .result;
    if (result.status == LocalizationStatus::kLocalized) {
      EXPECT_LT(result.map_from_base.Between(truth).translation().norm(), 0.01) << truth;
      ++found;
    }
  }
  return found;
}

TEST(LocalizerCompressionTest, MoreIsFoundOfImagesThatAreKnownToBePoor) {
  EXPECT_GE(FoundAt(2, true), FoundAt(2, false) + 3) << "T";
}

TEST(LocalizationNamesTest, AreTheContracts) {
  EXPECT_STREQ(ToString(LocalizationStatus::kLocalized), "localized");
  EXPECT_STREQ(ToString(LocalizationStatus::kAmbiguous), "ambiguous");
  EXPECT_STREQ(ToString(LocalizationStatus::kNotLocalized), "not_localized");
  EXPECT_STREQ(ToString(NotLocalizedReason::kTooFewKeypoints), "too_few_keypoints");
  EXPECT_STREQ(ToString(NotLocalizedReason::kNoFloor), "no_floor");
  EXPECT_STREQ(ToString(NotLocalizedReason::kOtherFloor), "other_floor");
}

}  // namespace
}  // namespace floorloc
