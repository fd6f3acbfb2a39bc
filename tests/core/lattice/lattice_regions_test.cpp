// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_regions.h"

#include <Eigen/LU>

#include "tests/core/lattice/repeating_floor.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

class LatticeRegionsTest : public RepeatingFloorTest {
 protected:
  std::vector<MapLattice> Find() const { return FindLatticeRegions(map_, {}, 1); }

  // Any basis of the lattice will do.
  static void ExpectBasis(const MapLattice& found, const Eigen::Matrix2d& basis) {
    const Eigen::Matrix2d whole = basis.inverse() * found.basis;
    EXPECT_LT((whole - whole.array().round().matrix()).cwiseAbs().maxCoeff(), 1e-3) << found.basis;
    EXPECT_NEAR(std::abs(whole.determinant()), 1.0, 2e-3) << found.basis;
  }
  static void ExpectExtent(const MapLattice& found, const RectM& extent) {
    constexpr double kMarginM = 0.35;  // patterns do not fill their cells
    EXPECT_NEAR(found.extent.x_min, extent.x_min, kMarginM);
    EXPECT_NEAR(found.extent.x_max, extent.x_max, kMarginM);
    EXPECT_NEAR(found.extent.y_min, extent.y_min, kMarginM);
    EXPECT_NEAR(found.extent.y_max, extent.y_max, kMarginM);
  }
  void AddPlainFloor(double x_m, double width_m, double height_m) {
    for (int i = 0; i < 3000; ++i) {
      Add(RandomPoint(width_m, height_m), RandomDescriptor(), Pose2(x_m, 0.0, 0.0));
    }
  }
};

TEST_F(LatticeRegionsTest, AHallOfManyBlocksIsOneRegion) {
  const Pose2 map_from_floor(0.0, 0.0, 0.1);
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 34, 14, map_from_floor);
  const std::vector<MapLattice> found = Find();
  ASSERT_EQ(found.size(), 1U);
  ExpectBasis(found[0], map_from_floor.rotation() * Basis(0.3, 0.0, 0.0, 0.3));
  EXPECT_EQ(found[0].floor_share, 1.0);
  EXPECT_GT(found[0].share, 0.9);
  EXPECT_NEAR(found[0].residual_m, 2.0 * noise_m_, noise_m_);
}

TEST_F(LatticeRegionsTest, RoomsWithOtherTilesAreToldApartAndPlainOnesLeftOut) {
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 26, 13, Pose2());             // to x = 7.8 m
  AddTiles(Basis(0.2, 0.0, 0.0, 0.4), 20, 10, Pose2(8.0, 0.0, 0));  // to x = 12 m
  AddPlainFloor(12.0, 4.0, 4.0);
  const std::vector<MapLattice> found = Find();
  ASSERT_EQ(found.size(), 2U);
  ExpectBasis(found[0], Basis(0.3, 0.0, 0.0, 0.3));
  ExpectBasis(found[1], Basis(0.2, 0.0, 0.0, 0.4));
  ExpectExtent(found[0], {0.0, 7.8, 0.0, 3.9});
  ExpectExtent(found[1], {8.0, 12.0, 0.0, 4.0});
  EXPECT_NEAR(found[0].floor_share, 0.5, 0.03);
  EXPECT_NEAR(found[1].floor_share, 0.25, 0.03);
}

TEST_F(LatticeRegionsTest, RoomsWithEqualTilesThatDoNotTouchAreTwo) {
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 13, 13, Pose2());
  AddPlainFloor(4.0, 4.0, 4.0);
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 13, 13, Pose2(8.1, 0.0, 0.0));
  EXPECT_EQ(Find().size(), 2U);
}

// The pattern has a point of which there are twice as many keypoints as of others.
TEST_F(LatticeRegionsTest, ThePointIsWhereTheMostCopiesAreAlsoFarFromTheOrigin) {
  const Pose2 map_from_floor(0.0, 0.0, 0.3);
  const Eigen::Matrix2d basis = Basis(0.3, 0.0, 0.0, 0.25);
  AddTiles(basis, 12, 12, map_from_floor);
  Keypoint special;
  special.x_m = 0.123F;
  special.y_m = 0.081F;
  for (int twice = 0; twice < 2; ++twice) {
    AddCopies(special, basis, 12, 12, map_from_floor);
  }
  map_.origin_m = {500000.0, 5300000.0};
  const std::vector<MapLattice> found = Find();
  ASSERT_EQ(found.size(), 1U);
  const Eigen::Vector2d in_floor = map_from_floor.Inverse() * (found[0].point_m - map_.origin_m);
  const Eigen::Vector2d cells = basis.inverse() * (in_floor - special.Position());
  EXPECT_LT((basis * (cells - cells.array().round().matrix())).norm(), 3e-4);
  const RectM& extent = found[0].extent;
  EXPECT_LT((found[0].point_m - extent.Center()).norm(), 0.2) << "near the middle";
}

TEST_F(LatticeRegionsTest, WhereNothingRepeatsThereIsNone) {
  EXPECT_TRUE(Find().empty()) << "no keypoints";
  AddPlainFloor(0.0, 8.0, 4.0);
  EXPECT_TRUE(Find().empty());
}

TEST_F(LatticeRegionsTest, FewKeypointsOrFloatDescriptorsSayNothing) {
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 3, 4, Pose2());
  EXPECT_TRUE(Find().empty());
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 8, 8, Pose2());
  EXPECT_FALSE(Find().empty());
  map_.descriptors.convertTo(map_.descriptors, CV_32F);
  EXPECT_TRUE(Find().empty());
}

TEST(LatticeRegionOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<LatticeRegionOptions>()
      .Refuses("block_m", &LatticeRegionOptions::block_m, {2.3})
      .Refuses("min_keypoints", &LatticeRegionOptions::min_keypoints, {1})
      .Refuses("max_difference_m", &LatticeRegionOptions::max_difference_m, {0.0})
      .Refuses("cell_m", &LatticeRegionOptions::cell_m, {0.0});
}

}  // namespace
}  // namespace floorloc
