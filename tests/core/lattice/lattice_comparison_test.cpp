// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/photometry/photometric_test_support.h"

namespace floorloc {
namespace {

constexpr double kResolutionM = 0.0007;
constexpr double kTileM = 0.3;
constexpr double kSideM = 2.1;
const int kMinCellSamples = PhotometricOptions().min_cell_samples;

FloorTexture Tiles() {
  FloorTextureOptions options = SyntheticFloor().SurveyOptions({}).floor;
  options.source = "tiles";
  options.width_m = kSideM;
  options.height_m = kSideM;
  return MakeFloorTexture(options);
}

// Every tile is the one in the corner.
FloorTexture IdenticalTiles() {
  FloorTexture floor = Tiles();
  const int side_px = static_cast<int>(std::lround(kTileM / floor.resolution_m));
  const cv::Mat tile = floor.bgr({0, 0, side_px, side_px}).clone();
  for (int v = 0; v < floor.bgr.rows; v += side_px) {
    for (int u = 0; u < floor.bgr.cols; u += side_px) {
      const cv::Rect place = cv::Rect(u, v, side_px, side_px) & cv::Rect({}, floor.bgr.size());
      tile({{}, place.size()}).copyTo(floor.bgr(place));
    }
  }
  return floor;
}

// A floor of tiles, its mosaic, and a camera above it.
class LatticeComparisonTest : public ::testing::Test {
 protected:
  explicit LatticeComparisonTest(FloorTexture floor = Tiles())
      : floor_(std::move(floor)),
        mosaic_(floor_, kResolutionM),
        raster_(mosaic_.Source(), mosaic_.layout(), ContrastOptions(), std::size_t{64} << 20),
        rectifier_(MakeDownwardCamera().AtResolution(kResolutionM)),
        renderer_(floor_, rectifier_.camera()) {}

  Pose2 PoseOfView(double x_m, double y_m, double yaw_rad) const {
    const Eigen::Vector2d center = rectifier_.camera().floor.roi.Center();
    return Pose2(x_m, y_m, yaw_rad) * Pose2(-center.x(), -center.y(), 0.0);
  }
  FrameSamples See(const Pose2& truth, const RenderConditions& conditions) const {
    cv::Mat gray;
    cv::cvtColor(renderer_.Render(truth, conditions), gray, cv::COLOR_BGR2GRAY);
    const GroundImage image = rectifier_.Rectify(gray);
    return {image, NormalizeContrast(image.gray, image.mask, ContrastOptions()), rectifier_};
  }
  // Of the frame, aligned at another place of the lattice.
  std::optional<LatticeComparison> CompareFrom(const FrameSamples& frame, const Pose2& truth,
                                               const Eigen::Vector2i& multiples,
                                               const LatticeComparisonOptions& options = {}) const {
    const FloorLattice lattice{kTileM * Eigen::Matrix2d::Identity(), 0.0, 1.0};
    const Eigen::Vector2d moved = kTileM * multiples.cast<double>();
    const Pose2 start(truth.x() + moved.x(), truth.y() + moved.y(), truth.yaw());
    const PhotometricFit fit = PhotometricAligner(raster_).Align(frame, start);
    return LatticeComparer(raster_, lattice, {0.0, kSideM, 0.0, kSideM}, options, kMinCellSamples)
        .Compare(frame, fit, options.max_places);
  }
  static RenderConditions Noisy() {
    RenderConditions conditions;
    conditions.read_noise = 6.0;
    conditions.defocus_px = 1.0;
    return conditions;
  }

  FloorTexture floor_;
  PerfectMosaic mosaic_;
  MosaicRaster raster_;
  Rectifier rectifier_;
  CameraRenderer renderer_;
};

TEST_F(LatticeComparisonTest, TheRightPlaceStandsOutWhereverThePoseWas) {
  const Pose2 truth = PoseOfView(1.02, 0.88, 0.7);
  const FrameSamples frame = See(truth, Noisy());
  for (const Eigen::Vector2i& from : {Eigen::Vector2i(0, 0), Eigen::Vector2i(2, -1), Eigen::Vector2i(-1, 2)}) {
    const std::optional<LatticeComparison> compared = CompareFrom(frame, truth, from);
    ASSERT_TRUE(compared);
    const LatticePlace& best = compared->places.front();
    EXPECT_EQ(best.multiples, -from);
    EXPECT_LT(ViewError(rectifier_.camera(), best.map_from_base, truth), 1e-3);
    EXPECT_GT(best.sigma, 6.0);
    EXPECT_LT(compared->places[1].sigma, 4.0);
    EXPECT_GT(best.log_likelihood, compared->places[1].log_likelihood + 5.0);
    EXPECT_EQ(compared->Find(truth), &best);
  }
}

TEST_F(LatticeComparisonTest, AGlanceAtAllPlacesFindsTheFewThatAreWorthMore) {
  const Pose2 truth = PoseOfView(1.02, 0.88, 0.7);
  LatticeComparisonOptions options;
  options.typical_places = options.min_places;
  options.promising_places = 2;
  const FrameSamples frame = See(truth, Noisy());
  for (const Eigen::Vector2i& from : {Eigen::Vector2i(0, 0), Eigen::Vector2i(2, 2)}) {  // among the nearest, and not
    const std::optional<LatticeComparison> all = CompareFrom(frame, truth, from);
    const std::optional<LatticeComparison> compared = CompareFrom(frame, truth, from, options);
    ASSERT_TRUE(all && compared);
    EXPECT_EQ(compared->places.front().multiples, -from);
    EXPECT_GT(compared->places.front().sigma, 6.0);
    EXPECT_LT(compared->places[1].sigma, 5.0);
    EXPECT_EQ(compared->places.size(), all->places.size()) << "those that were glanced at count, too";
    EXPECT_LT((compared->places.front().map_from_base.Inverse() * truth).translation().norm(), 1e-3);
  }
}

TEST_F(LatticeComparisonTest, APoseBesideThePlacesIsNone) {
  const Pose2 truth = PoseOfView(1.02, 0.88, 0.7);
  const std::optional<LatticeComparison> compared = CompareFrom(See(truth, {}), truth, {0, 0});
  ASSERT_TRUE(compared);
  EXPECT_EQ(compared->Find(Pose2(truth.x() + 0.5 * kTileM, truth.y(), truth.yaw())), nullptr);
  EXPECT_EQ(compared->Find(Pose2(truth.x(), truth.y(), truth.yaw() + 1.5)), nullptr);
}

TEST_F(LatticeComparisonTest, NoneStandsOutIfTheRightPlaceIsNotCompared) {
  const Pose2 truth = PoseOfView(0.5, 0.45, 0.7);
  const FrameSamples frame = See(truth, Noisy());
  const FloorLattice lattice{kTileM * Eigen::Matrix2d::Identity(), 0.0, 1.0};
  const Pose2 elsewhere(truth.x() + 3.0 * kTileM, truth.y() + 3.0 * kTileM, truth.yaw());
  const PhotometricFit fit = PhotometricAligner(raster_).Align(frame, elsewhere);
  const std::optional<LatticeComparison> compared =
      LatticeComparer(raster_, lattice, {0.7, kSideM, 0.7, kSideM}, {}, kMinCellSamples).Compare(frame, fit, 200);
  ASSERT_TRUE(compared);
  EXPECT_LT(compared->places.front().sigma, 4.0);
}

class IdenticalTilesTest : public LatticeComparisonTest {
 protected:
  IdenticalTilesTest() : LatticeComparisonTest(IdenticalTiles()) {}
};

TEST_F(IdenticalTilesTest, NoPlaceIsMuchLikelierThanTheNext) {
  const Pose2 truth = PoseOfView(1.02, 0.88, 0.7);
  const std::optional<LatticeComparison> compared = CompareFrom(See(truth, Noisy()), truth, {1, 0});
  ASSERT_TRUE(compared);
  EXPECT_LT(compared->places.front().log_likelihood - compared->places[1].log_likelihood, 4.0);
}

TEST_F(LatticeComparisonTest, FewPlacesSayNothing) {
  const Pose2 truth = PoseOfView(1.02, 0.88, 0.7);
  LatticeComparisonOptions options;
  options.min_places = 200;
  EXPECT_FALSE(CompareFrom(See(truth, {}), truth, {0, 0}, options));
}

}  // namespace
}  // namespace floorloc
