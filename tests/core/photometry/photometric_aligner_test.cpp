// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/photometric_aligner.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/core/photometry/photometric_test_support.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kResolutionM = 0.0007;
constexpr double kAccurateM = 0.2 * kResolutionM;

// A synthetic floor, its mosaic, and a camera above it.
class PhotometricAlignerTest : public ::testing::Test {
 protected:
  static const FloorTexture& Floor() {
    static const FloorTexture floor = MakeFloorTexture(SyntheticFloor().SurveyOptions({}).floor);
    return floor;
  }
  static const MosaicRaster& Raster() {
    static const PerfectMosaic mosaic(Floor(), kResolutionM);
    static const MosaicRaster raster(mosaic.Source(), mosaic.layout(), ContrastOptions(), std::size_t{64} << 20);
    return raster;
  }

  explicit PhotometricAlignerTest(const FloorCamera& camera = MakeDownwardCamera())
      : rectifier_(camera.AtResolution(kResolutionM)), renderer_(Floor(), camera) {}

  double Uniform(double half) { return std::uniform_real_distribution<double>(-half, half)(rng_); }
  double Normal(double sigma) { return sigma * std::normal_distribution<double>()(rng_); }
  const FloorCamera& camera() const { return rectifier_.camera(); }

  // A pose whose whole image is on the floor.
  Pose2 RandomTruth() {
    const Eigen::Vector2d center = camera().floor.roi.Center();
    return Pose2(0.6 + Uniform(0.3), 0.45 + Uniform(0.15), Uniform(kPi)) * Pose2(-center.x(), -center.y(), 0.0);
  }
  // Perturbed about the image centre, like poses from keypoints.
  Pose2 Moved(const Pose2& truth, double shift_m, double turn_rad) {
    const Eigen::Vector2d center = camera().floor.roi.Center();
    const double direction = Uniform(kPi);
    return truth * Pose2(shift_m * std::cos(direction), shift_m * std::sin(direction), 0.0) *
           Pose2(center.x(), center.y(), turn_rad) * Pose2(-center.x(), -center.y(), 0.0);
  }

  cv::Mat GrayView(const Pose2& truth, const RenderConditions& conditions) const {
    cv::Mat gray;
    cv::cvtColor(renderer_.Render(truth, conditions), gray, cv::COLOR_BGR2GRAY);
    return gray;
  }
  PhotometricFit AlignView(const cv::Mat& gray, const Pose2& start) const {
    const GroundImage image = rectifier_.Rectify(gray);
    const FrameSamples samples(image, NormalizeContrast(image.gray, image.mask, ContrastOptions()), rectifier_);
    return PhotometricAligner(Raster(), options_).Align(samples, start);
  }
  double ErrorOf(const PhotometricFit& fit, const Pose2& truth) const {
    return ViewError(camera(), fit.map_from_base, truth);
  }

  // Aligns the image of a vibrating camera, starting at the pose that keypoints would give.
  void ExpectVibrationIsAbsorbed(const CameraVibration& vibration) {
    const Pose2 truth = RandomTruth();
    const MountingError error = ToMountingError(vibration, camera());
    const Pose2 rigid = RigidFit(camera(), truth, error);
    RenderConditions conditions;
    conditions.vibration = vibration;
    const PhotometricFit fit = AlignView(GrayView(truth, conditions), rigid);
    EXPECT_NEAR(fit.mounting.rotation_rad.x(), error.rotation_rad.x(), 5e-4);
    EXPECT_NEAR(fit.mounting.rotation_rad.y(), error.rotation_rad.y(), 5e-4);
    EXPECT_NEAR(fit.mounting.height_share, error.height_share, 5e-4);
    EXPECT_LT(ErrorOf(fit, truth), 0.25 * ViewError(camera(), rigid, truth)) << vibration.pitch_rad;
  }

  PhotometricOptions options_;
  std::mt19937_64 rng_{17};
  Rectifier rectifier_;
  CameraRenderer renderer_;
};

class ForwardCameraTest : public PhotometricAlignerTest {
 protected:
  ForwardCameraTest() : PhotometricAlignerTest(MakeForwardCamera()) {}
};

constexpr CameraVibration kVibrations[] = {
    {.pitch_rad = 0.005}, {.roll_rad = -0.005}, {.pitch_rad = -0.004, .roll_rad = 0.003, .height_m = 0.003}};

TEST_F(PhotometricAlignerTest, FindsTheTruePoseFromAFewPixelsAway) {
  for (int round = 0; round < 20; ++round) {
    const Pose2 truth = RandomTruth();
    const Pose2 start = Moved(truth, 3.0 * kResolutionM, Uniform(0.01));
    const PhotometricFit fit = AlignView(GrayView(truth, {}), start);
    EXPECT_LT(ErrorOf(fit, truth), kAccurateM) << truth;
    EXPECT_NEAR(fit.moved_m, 3.0 * kResolutionM, 2.0 * kAccurateM);
    EXPECT_GT(fit.MeanCorrelation(), 0.7);
  }
}

// The motion during the read-out by which rows were put where they belong is off by a millimetre to the side: what it
// shears looks like a turn of the robot. Or it is off by a turn, which bends the image.
TEST_F(PhotometricAlignerTest, RowsThatAreNotWhereTheyBelongAreFound) {
  const std::vector<Eigen::Vector3d> motions{
      {0.0, 0.001, 0.0}, {0.0, -0.001, 0.0}, {0.0, 0.0, 0.01}, {0.0, 0.0, -0.01}};
  for (const Eigen::Vector3d& off : motions) {
    const Pose2 truth = RandomTruth();
    RenderConditions conditions;
    conditions.readout_motion = off;
    const GroundImage image = rectifier_.Rectify(GrayView(truth, conditions));
    FrameSamples samples(image, NormalizeContrast(image.gray, image.mask, ContrastOptions()), rectifier_);
    const PhotometricAligner aligner(Raster(), options_);
    const double taken_as_exact_m = ErrorOf(aligner.Align(samples, truth), truth);
    samples.SetReadout(camera(), {0.001, 0.001, 0.01});
    EXPECT_LT(ErrorOf(aligner.Align(samples, truth), truth), 0.4 * taken_as_exact_m);
    EXPECT_GT(taken_as_exact_m, 2e-4);
  }
}

TEST_F(PhotometricAlignerTest, ATrueStartStays) {
  const Pose2 truth = RandomTruth();
  const PhotometricFit fit = AlignView(GrayView(truth, {}), truth);
  EXPECT_LT(ErrorOf(fit, truth), kAccurateM);
  EXPECT_LT(fit.moved_m, kAccurateM);
  EXPECT_LT(fit.mounting.rotation_rad.norm(), 3e-4);
  EXPECT_LT(std::abs(fit.mounting.height_share), 3e-4);
}

TEST_F(PhotometricAlignerTest, VibrationIsAbsorbed) {
  for (const CameraVibration& vibration : kVibrations) {
    ExpectVibrationIsAbsorbed(vibration);
  }
}

TEST_F(ForwardCameraTest, FindsTheTruePoseFromAFewPixelsAway) {
  for (int round = 0; round < 5; ++round) {
    const Pose2 truth = RandomTruth();
    const PhotometricFit fit = AlignView(GrayView(truth, {}), Moved(truth, 2.0 * kResolutionM, Uniform(0.005)));
    EXPECT_LT(ErrorOf(fit, truth), kAccurateM) << truth;
  }
}

TEST_F(ForwardCameraTest, VibrationIsAbsorbed) {
  for (const CameraVibration& vibration : kVibrations) {
    ExpectVibrationIsAbsorbed(vibration);
  }
}

TEST_F(PhotometricAlignerTest, AChangedFifthOfTheFloorSpoilsOnlyItsCells) {
  for (int round = 0; round < 10; ++round) {
    const Pose2 truth = RandomTruth();
    cv::Mat gray = GrayView(truth, {});
    const PhotometricFit whole = AlignView(gray, truth);
    cv::RNG random(static_cast<std::uint64_t>(round) + 1);
    for (int i = 0; i < 4; ++i) {  // 4 x 5 % of the image
      const cv::Rect paint(random.uniform(0, 640 - 140), 120 * i, 140, 110);
      cv::Mat speckles(paint.size(), CV_8UC1);
      random.fill(speckles, cv::RNG::UNIFORM, 60, 200);
      cv::GaussianBlur(speckles, gray(paint), {}, 1.5);
    }
    const PhotometricFit fit = AlignView(gray, Moved(truth, 1.5 * kResolutionM, Uniform(0.004)));
    EXPECT_LT(ErrorOf(fit, truth), 1.5 * kAccurateM) << truth;
    int spoilt = 0;
    for (std::size_t c = 0; c < fit.cell_correlation.size(); ++c) {
      spoilt += fit.cell_correlation[c] < 0.5F * whole.cell_correlation[c] ? 1 : 0;
    }
    const auto cells = static_cast<double>(fit.cell_correlation.size());
    EXPECT_GT(spoilt, 0.05 * cells);
    EXPECT_LT(spoilt, 0.35 * cells);
  }
}

TEST_F(PhotometricAlignerTest, OffTheMosaicNothingCompares) {
  const Pose2 truth = RandomTruth();
  const cv::Mat gray = GrayView(truth, {});
  for (const double wild : {50.0, -50.0, 1e9, 1e300, -1e300, std::nan("")}) {
    const PhotometricFit fit = AlignView(gray, Pose2(wild, 0.3, 0.1));
    EXPECT_EQ(fit.MeanCorrelation(), 0.0) << wild;
    for (const int samples : fit.cell_samples) {
      EXPECT_EQ(samples, 0) << wild;
    }
    EXPECT_TRUE(fit.covariance.allFinite()) << wild;
  }
}

TEST_F(PhotometricAlignerTest, AtTheEdgeOfTheMosaicTheRestOfTheViewAligns) {
  const Eigen::Vector2d center = camera().floor.roi.Center();
  const Pose2 truth = Pose2(0.05, 0.45, 0.0) * Pose2(-center.x(), -center.y(), 0.0);
  const PhotometricFit fit = AlignView(GrayView(truth, {}), Moved(truth, kResolutionM, 0.0));
  EXPECT_LT(ErrorOf(fit, truth), 2.0 * kAccurateM);
  const auto empty = std::count(fit.cell_samples.begin(), fit.cell_samples.end(), 0);
  EXPECT_GT(empty, 0);
  EXPECT_LT(static_cast<std::size_t>(empty), fit.cell_samples.size());
}

TEST_F(PhotometricAlignerTest, AnotherPlaceDoesNotCorrelate) {
  for (int round = 0; round < 10; ++round) {
    const Pose2 truth = RandomTruth();
    EXPECT_LT(AlignView(GrayView(truth, {}), RandomTruth()).MeanCorrelation(), 0.15) << truth;
  }
}

TEST_F(PhotometricAlignerTest, CovarianceIsHonest) {
  options_.calibration_sigma_px = 0.0;  // the camera is exact
  constexpr int kViews = 50;
  double sum = 0.0;
  for (int view = 0; view < kViews; ++view) {
    const Pose2 truth = RandomTruth();
    RenderConditions conditions;
    conditions.read_noise = 6.0;
    conditions.gain = 0.9;
    conditions.noise_seed = static_cast<std::uint64_t>(view) + 1;
    conditions.vibration = {Normal(1e-3), Normal(1e-3), Normal(4e-4)};
    const Pose2 start = Moved(truth, kResolutionM, Uniform(0.002));
    const PhotometricFit fit = AlignView(GrayView(truth, conditions), start);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(fit.covariance);
    ASSERT_GT(eigen.eigenvalues().minCoeff(), 0.0);
    const Pose2& pose = fit.map_from_base;
    const Eigen::Vector3d error(pose.x() - truth.x(), pose.y() - truth.y(), WrapAngle(pose.yaw() - truth.yaw()));
    sum += error.dot(fit.covariance.ldlt().solve(error));
  }
  const double nees = sum / kViews;  // 3 expected
  EXPECT_GT(nees, 1.5);
  EXPECT_LT(nees, 5.0);
}

// A blurred frame lacks what a sharp mosaic shows: slopes that promise too much make the covariance too small.
TEST_F(PhotometricAlignerTest, BlurredFramesAreComparedWithABlurredMosaic) {
  options_.calibration_sigma_px = 0.0;  // the camera is exact
  constexpr int kViews = 15;
  double error_m[] = {0.0, 0.0};
  double nees[] = {0.0, 0.0};
  for (int view = 0; view < kViews; ++view) {
    const Pose2 truth = RandomTruth();
    RenderConditions conditions;
    conditions.motion = {0.008, 0.0, 0.0};
    conditions.vibration = {Normal(4e-3), Normal(4e-3), 0.0};
    conditions.read_noise = 3.0;
    conditions.noise_seed = static_cast<std::uint64_t>(view) + 1;
    const cv::Mat gray = GrayView(truth, conditions);
    const Pose2 start = Moved(truth, kResolutionM, Uniform(0.002));
    for (const int adapted : {0, 1}) {
      options_.max_blur_level = adapted * MosaicRaster::kMaxBlurLevel;
      const PhotometricFit fit = AlignView(gray, start);
      const Eigen::Vector3d off(fit.map_from_base.x() - truth.x(), fit.map_from_base.y() - truth.y(),
                                WrapAngle(fit.map_from_base.yaw() - truth.yaw()));
      error_m[adapted] += ErrorOf(fit, truth) / kViews;
      nees[adapted] += off.dot(fit.covariance.ldlt().solve(off)) / kViews;
    }
  }
  EXPECT_LT(error_m[1], 0.6 * error_m[0]);
  EXPECT_LT(nees[1], 6.0) << "of a sharp mosaic: " << nees[0];
}

TEST(FrameSamplesTest, TakesTheSeenPixelsCellByCell) {
  GroundImage image{{0.5, 0.2, 0.001, 100, 60}, {}, cv::Mat(60, 100, CV_8UC1, cv::Scalar(255))};
  image.mask(cv::Rect(0, 0, 50, 60)).setTo(0);
  cv::Mat normalized(60, 100, CV_8UC1, cv::Scalar(128));
  normalized(cv::Rect(70, 0, 30, 60)).setTo(200);
  const FrameSamples samples(image, normalized, Rectifier(MakeDownwardCamera()));
  ASSERT_EQ(samples.cells(), 6);
  EXPECT_LT((samples.center() - Eigen::Vector2d(0.4705, 0.1505)).norm(), 1e-12);
  EXPECT_NEAR(samples.radius_m(), 0.0583, 1e-4);
  EXPECT_TRUE(samples.cell(0).empty());
  EXPECT_TRUE(samples.cell(3).empty());
  std::size_t count = 0;
  for (int c = 0; c < samples.cells(); ++c) {
    count += samples.cell(c).size();
    for (const FrameSamples::Sample& sample : samples.cell(c)) {
      const Eigen::Vector2d pixel = image.grid.PixelFromBase({sample.x_m, sample.y_m});
      EXPECT_GE(pixel.x(), 50.0 - 1e-3);
      EXPECT_EQ(sample.value, pixel.x() > 69.5 ? 72.0F : 0.0F);
    }
  }
  EXPECT_GT(count, 50U);
}

}  // namespace
}  // namespace floorloc
