// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/floor_lattice.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/core/lattice/repeating_floor.h"

namespace floorloc {
namespace {

class FloorLatticeTest : public RepeatingFloorTest {
 protected:
  std::optional<FloorLattice> Find() const {
    return FindFloorLattice(map_, *CreateDescriptorIndex(map_.descriptors, {MatcherType::kBruteForce}), {}, 1);
  }
  // Both bases have the same whole multiples.
  static void ExpectSameLattice(const FloorLattice& found, const Eigen::Matrix2d& basis) {
    const Eigen::Matrix2d whole = basis.inverse() * found.basis;
    EXPECT_LT((whole - whole.array().round().matrix()).cwiseAbs().maxCoeff(), 2e-3) << found.basis;
    EXPECT_NEAR(std::abs(whole.determinant()), 1.0, 5e-3) << found.basis;
  }
};

TEST_F(FloorLatticeTest, OfRectangularTilesInAnyDirection) {
  const Pose2 map_from_floor(3.0, -2.0, 0.4);
  AddTiles(Basis(0.3, 0.0, 0.0, 0.2), 7, 8, map_from_floor);
  const std::optional<FloorLattice> lattice = Find();
  ASSERT_TRUE(lattice);
  ExpectSameLattice(*lattice, map_from_floor.rotation() * Basis(0.3, 0.0, 0.0, 0.2));
  EXPECT_GT(lattice->share, 0.9);
  EXPECT_NEAR(lattice->residual_m, 2.0 * noise_m_, noise_m_);
}

TEST_F(FloorLatticeTest, OfARunningBond) {
  AddTiles(Basis(0.4, 0.0, 0.2, 0.25), 6, 6, Pose2());
  const std::optional<FloorLattice> lattice = Find();
  ASSERT_TRUE(lattice);
  ExpectSameLattice(*lattice, Basis(0.4, 0.0, 0.2, 0.25));
}

TEST_F(FloorLatticeTest, NearestMultiplesOfATranslation) {
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 6, 6, Pose2());
  const std::optional<FloorLattice> lattice = Find();
  ASSERT_TRUE(lattice);
  const Eigen::Vector2i nearest = lattice->Nearest(Eigen::Vector2d(0.91, -0.58));
  EXPECT_LT((lattice->basis * nearest.cast<double>() - Eigen::Vector2d(0.9, -0.6)).norm(), 5e-3);
}

TEST_F(FloorLatticeTest, AFloorThatDoesNotRepeatHasNone) {
  for (int i = 0; i < 2000; ++i) {
    Add(RandomPoint(2.0, 2.0), RandomDescriptor(), Pose2());
  }
  EXPECT_FALSE(Find());
}

// Planks or stripes: what repeats in one direction says nothing about places along the other.
TEST_F(FloorLatticeTest, RepetitionInOneDirectionIsNone) {
  AddTiles(Basis(0.3, 0.0, 0.0, 0.3), 20, 1, Pose2());
  EXPECT_FALSE(Find());
}

// The same speck all over a floor, at random.
TEST_F(FloorLatticeTest, CopiesAtRandomPlacesAreNone) {
  const cv::Mat descriptor = RandomDescriptor();
  for (int i = 0; i < 2000; ++i) {
    Keypoint k = RandomPoint(2.0, 2.0);
    k.angle_rad = 0.0F;
    Add(k, SeenAgain(descriptor), Pose2());
  }
  EXPECT_FALSE(Find());
}

TEST_F(FloorLatticeTest, OfFloatDescriptorsAndEmptyMapsNothingIsKnown) {
  map_.keypoints.resize(100);
  map_.descriptors = cv::Mat::zeros(100, 64, CV_32FC1);
  EXPECT_FALSE(Find());
  map_.keypoints.clear();
  map_.descriptors = cv::Mat(0, kBytes, CV_8UC1);
  EXPECT_FALSE(Find());
}

}  // namespace
}  // namespace floorloc
