// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace floorloc {
namespace {

StampedPose3 PoseAt(const Eigen::Vector3d& position) { return {0, position, Eigen::Quaterniond::Identity()}; }

// Estimates at random positions in a box; references are their images under `truth`.
std::vector<PosePair> Scattered(const Similarity3& truth, const Eigen::Vector3d& box) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<PosePair> pairs;
  for (int i = 0; i < 50; ++i) {
    const StampedPose3 estimate = PoseAt({box.x() * any(rng), box.y() * any(rng), box.z() * any(rng)});
    pairs.push_back({truth * estimate, estimate});
  }
  return pairs;
}

void ExpectNear(const Similarity3& a, const Similarity3& b) {
  EXPECT_NEAR(a.scale, b.scale, 1e-9);
  EXPECT_LT((a.translation_m - b.translation_m).norm(), 1e-9);
  EXPECT_LT(a.rotation.angularDistance(b.rotation), 1e-7);
}

const Eigen::Quaterniond kTilted(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -2, 3).normalized()));
const Eigen::Quaterniond kYaw(Eigen::AngleAxisd(-2.0, Eigen::Vector3d::UnitZ()));

TEST(Alignment, FindsTheExactMotion) {
  const Similarity3 planar{kYaw, {1, -2, 0}, 1.0};
  ExpectNear(ComputeAlignment(Scattered(planar, {3, 2, 1}), AlignmentMode::kSe2), planar);
  const Similarity3 rigid{kTilted, {1, -2, 3}, 1.0};
  ExpectNear(ComputeAlignment(Scattered(rigid, {3, 2, 1}), AlignmentMode::kSe3), rigid);
  const Similarity3 scaled{kTilted, {1, -2, 3}, 0.4};
  ExpectNear(ComputeAlignment(Scattered(scaled, {3, 2, 1}), AlignmentMode::kSim3), scaled);
}

TEST(Alignment, PlanarTrajectoriesAlignInSpaceWithoutMirroring) {
  const Similarity3 rigid{kYaw, {1, -2, 0}, 1.0};
  ExpectNear(ComputeAlignment(Scattered(rigid, {3, 2, 0}), AlignmentMode::kSe3), rigid);
}

TEST(Alignment, AStraightDriveAlignsInThePlaneOnly) {
  const Similarity3 rigid{kYaw, {1, -2, 0}, 1.0};
  const std::vector<PosePair> line = Scattered(rigid, {3, 0, 0});
  ExpectNear(ComputeAlignment(line, AlignmentMode::kSe2), rigid);
  EXPECT_THROW(ComputeAlignment(line, AlignmentMode::kSe3), std::invalid_argument);
  EXPECT_THROW(ComputeAlignment(line, AlignmentMode::kSim3), std::invalid_argument);
}

// Rounding gives a diagonal line a nonzero width; a rotation about the line estimated from that would be random.
TEST(Alignment, RoundingIsNoWidth) {
  std::vector<PosePair> line;
  for (int i = 0; i < 100; ++i) {
    const StampedPose3 pose = PoseAt((0.1 * i) * Eigen::Vector3d(0.3, 0.7, 0.1) + Eigen::Vector3d(1000, -300, 2));
    line.push_back({pose, PoseAt(1.1 * pose.translation_m)});
  }
  EXPECT_THROW(ComputeAlignment(line, AlignmentMode::kSe3), std::invalid_argument);
  EXPECT_THROW(ComputeAlignment(line, AlignmentMode::kSim3), std::invalid_argument);
  EXPECT_NO_THROW(ComputeAlignment(line, AlignmentMode::kSe2));
  const std::vector<PosePair> far_spot(10, {PoseAt({1e6, 2e6, 0.1}), PoseAt({3e5, 0.7, 0})});
  EXPECT_THROW(ComputeAlignment(far_spot, AlignmentMode::kSe2), std::invalid_argument);
}

TEST(Alignment, ScaleAloneLeavesTheFrame) {
  const Similarity3 found = ComputeAlignment(Scattered({kTilted, {1, -2, 3}, 0.4}, {3, 2, 1}), AlignmentMode::kScale);
  ExpectNear(found, {Eigen::Quaterniond::Identity(), {0, 0, 0}, 0.4});
}

TEST(Alignment, OriginMovesTheFirstPoseOntoItsReference) {
  const Similarity3 there{kTilted, {1, -2, 3}, 1.0};
  PosePair first{PoseAt({5, 6, 7}), PoseAt({1, 1, 1})};
  first.estimate.rotation = kYaw;
  first.reference = there * first.estimate;
  const PosePair wrong{PoseAt({100, 0, 0}), PoseAt({0, 0, 0})};
  ExpectNear(ComputeAlignment({first, wrong}, AlignmentMode::kOrigin), there);
  EXPECT_THROW(ComputeAlignment({}, AlignmentMode::kOrigin), std::invalid_argument);
}

TEST(Alignment, RefusesOneSpot) {
  const std::vector<PosePair> spot = Scattered({}, {0, 0, 0});
  EXPECT_THROW(ComputeAlignment(spot, AlignmentMode::kSe2), std::invalid_argument);
  EXPECT_THROW(ComputeAlignment({}, AlignmentMode::kSe2), std::invalid_argument);
  ExpectNear(ComputeAlignment(spot, AlignmentMode::kNone), {});
}

TEST(Alignment, NeverMirrors) {
  std::vector<PosePair> pairs = Scattered({}, {3, 2, 1});
  for (PosePair& pair : pairs) {
    pair.reference.translation_m.y() *= -1;
  }
  for (const AlignmentMode mode : {AlignmentMode::kSe2, AlignmentMode::kSe3, AlignmentMode::kSim3}) {
    const Similarity3 found = ComputeAlignment(pairs, mode);
    EXPECT_NEAR(found.rotation.norm(), 1.0, 1e-12);
    EXPECT_NEAR(found.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
  }
}

// Computed by hand: centred squares of side 2 and side 1; scale 2 for sim3, 1 for se3.
TEST(Alignment, OnlySim3Scales) {
  std::vector<PosePair> pairs;
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(-1, 1, 0), Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, -1, 0)}) {
    pairs.push_back({PoseAt(corner), PoseAt(0.5 * corner)});
  }
  EXPECT_NEAR(ComputeAlignment(pairs, AlignmentMode::kSim3).scale, 2.0, 1e-12);
  EXPECT_EQ(ComputeAlignment(pairs, AlignmentMode::kSe3).scale, 1.0);
  EXPECT_EQ(ComputeAlignment(pairs, AlignmentMode::kSe2).scale, 1.0);
}

TEST(Alignment, IsTheLeastSquaresOne) {
  std::vector<PosePair> pairs = Scattered({kYaw, {1, -2, 0}, 1.0}, {3, 2, 0});
  std::mt19937_64 rng(12);
  std::normal_distribution<double> noise(0, 0.1);
  for (PosePair& pair : pairs) {
    pair.reference.translation_m += Eigen::Vector3d(noise(rng), noise(rng), 0);
  }
  const auto cost = [&](const Similarity3& s) {
    double sum = 0.0;
    for (const PosePair& pair : Align(pairs, s)) {
      sum += (pair.reference.translation_m - pair.estimate.translation_m).squaredNorm();
    }
    return sum;
  };
  const Similarity3 best = ComputeAlignment(pairs, AlignmentMode::kSe2);
  for (const double step : {-1e-3, 1e-3}) {
    Similarity3 turned = best;
    turned.rotation = Eigen::AngleAxisd(step, Eigen::Vector3d::UnitZ()) * best.rotation;
    EXPECT_GT(cost(turned), cost(best));
    Similarity3 shifted = best;
    shifted.translation_m.x() += step;
    EXPECT_GT(cost(shifted), cost(best));
  }
}

}  // namespace
}  // namespace floorloc
