// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/floor_lattice.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "core/geometry/pose2.h"

namespace floorloc {
namespace {

constexpr int kBytes = 32;

// Keypoints of a floor on which a pattern of points is repeated.
class FloorLatticeTest : public ::testing::Test {
 protected:
  Keypoint RandomPoint(double width_m, double height_m) {
    Keypoint k;
    k.x_m = static_cast<float>(Uniform() * width_m);
    k.y_m = static_cast<float>(Uniform() * height_m);
    k.angle_rad = static_cast<float>(6.28 * Uniform());
    return k;
  }
  cv::Mat RandomDescriptor() {
    cv::Mat row(1, kBytes, CV_8UC1);
    for (int b = 0; b < kBytes; ++b) {
      row.at<std::uint8_t>(0, b) = static_cast<std::uint8_t>(random_() % 256);
    }
    return row;
  }
  cv::Mat SeenAgain(const cv::Mat& descriptor) {
    cv::Mat again = descriptor.clone();
    for (int flip = 0; flip < 6; ++flip) {
      again.at<std::uint8_t>(0, static_cast<int>(random_() % kBytes)) ^= static_cast<std::uint8_t>(1U << random_() % 8);
    }
    return again;
  }
  void Add(Keypoint k, const cv::Mat& descriptor, const Pose2& map_from_floor) {
    const Eigen::Vector2f p = (map_from_floor * k.Position()).cast<float>();
    k.x_m = p.x() + static_cast<float>(noise_m_ * normal_(random_));
    k.y_m = p.y() + static_cast<float>(noise_m_ * normal_(random_));
    k.angle_rad = static_cast<float>(WrapAngle(static_cast<double>(k.angle_rad) + map_from_floor.yaw()));
    map_.keypoints.push_back(k);
    map_.descriptors.push_back(descriptor);
  }
  // Copies of one pattern at all whole multiples of the basis from 0 to columns - 1, rows - 1.
  void AddTiles(const Eigen::Matrix2d& basis, int columns, int rows, const Pose2& map_from_floor) {
    for (int point = 0; point < 40; ++point) {
      const Keypoint k = RandomPoint(0.2, 0.2);
      const cv::Mat descriptor = RandomDescriptor();
      for (int i = 0; i < columns; ++i) {
        for (int j = 0; j < rows; ++j) {
          Keypoint copy = k;
          const Eigen::Vector2f moved = (basis * Eigen::Vector2d(i, j)).cast<float>();
          copy.x_m += moved.x();
          copy.y_m += moved.y();
          Add(copy, SeenAgain(descriptor), map_from_floor);
        }
      }
    }
  }
  std::optional<FloorLattice> Find() const {
    return FindFloorLattice(map_, *CreateDescriptorIndex(map_.descriptors, {MatcherType::kBruteForce}), {}, 1);
  }
  // Both bases have the same whole multiples.
  static void ExpectSameLattice(const FloorLattice& found, const Eigen::Matrix2d& basis) {
    const Eigen::Matrix2d whole = basis.inverse() * found.basis;
    EXPECT_LT((whole - whole.array().round().matrix()).cwiseAbs().maxCoeff(), 2e-3) << found.basis;
    EXPECT_NEAR(std::abs(whole.determinant()), 1.0, 5e-3) << found.basis;
  }
  static Eigen::Matrix2d Basis(double ax, double ay, double bx, double by) {
    return (Eigen::Matrix2d() << ax, bx, ay, by).finished();
  }

  MapKeypoints map_;
  double noise_m_ = 5e-4;
  std::mt19937 random_{3};

 private:
  double Uniform() { return std::uniform_real_distribution<double>()(random_); }
  std::normal_distribution<double> normal_;
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
