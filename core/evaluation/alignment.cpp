// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cassert>
#include <limits>
#include <stdexcept>

namespace floorloc {
namespace {

// Positions within about a millionth of their extent of a line count as collinear: the deviation is rounding error and
// would rotate the trajectory about the line at random.
constexpr double kFlatness = 1e-12;

template <int kDim>
struct SimilarityN {
  Eigen::Matrix<double, kDim, kDim> rotation;
  Eigen::Matrix<double, kDim, 1> translation;
  double scale = 1.0;
};

// Umeyama, "Least-squares estimation of transformation parameters between two point patterns" (1991), eq. 34 to 43.
template <int kDim>
SimilarityN<kDim> Umeyama(const std::vector<PosePair>& pairs, bool with_scale) {
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  using Vector = Eigen::Matrix<double, kDim, 1>;
  const double n = static_cast<double>(pairs.size());
  Vector mean_estimate = Vector::Zero();
  Vector mean_reference = Vector::Zero();
  for (const PosePair& pair : pairs) {
    mean_estimate += pair.estimate.translation_m.head<kDim>() / n;
    mean_reference += pair.reference.translation_m.head<kDim>() / n;
  }
  Matrix covariance = Matrix::Zero();
  double variance_estimate = 0.0;
  for (const PosePair& pair : pairs) {
    const Vector estimate = pair.estimate.translation_m.head<kDim>() - mean_estimate;
    const Vector reference = pair.reference.translation_m.head<kDim>() - mean_reference;
    covariance += reference * estimate.transpose() / n;
    variance_estimate += estimate.squaredNorm() / n;
  }
  const Eigen::JacobiSVD<Matrix> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // One singular value may be zero (a plane in space, a line in the plane): the rotation is still determined.
  const double rounding_m =
      16.0 * std::numeric_limits<double>::epsilon() * (mean_estimate.norm() + mean_reference.norm());
  if (!(svd.singularValues()(kDim - 2) > kFlatness * svd.singularValues()(0) + rounding_m * rounding_m)) {
    throw std::invalid_argument(kDim == 2 ? "the positions do not determine the alignment because they lie on one "
                                            "spot; align with origin or none"
                                          : "the positions do not determine the alignment because they lie on one "
                                            "spot or line; align with se2, origin or none");
  }
  Vector signs = Vector::Ones();
  signs(kDim - 1) = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  SimilarityN<kDim> result;
  result.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  result.scale = with_scale ? svd.singularValues().dot(signs) / variance_estimate : 1.0;
  result.translation = mean_reference - result.scale * result.rotation * mean_estimate;
  return result;
}

Similarity3 FromPlane(const SimilarityN<2>& planar) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation.topLeftCorner<2, 2>() = planar.rotation;
  return {Eigen::Quaterniond(rotation), {planar.translation.x(), planar.translation.y(), 0.0}, 1.0};
}

Similarity3 FromSpace(const SimilarityN<3>& spatial) {
  return {Eigen::Quaterniond(spatial.rotation), spatial.translation, spatial.scale};
}

Similarity3 AlignToFirst(const PosePair& first) {
  const Eigen::Quaterniond rotation = (first.reference.rotation * first.estimate.rotation.conjugate()).normalized();
  return {rotation, first.reference.translation_m - rotation * first.estimate.translation_m, 1.0};
}

}  // namespace

StampedPose3 Similarity3::operator*(const StampedPose3& pose) const {
  return {pose.stamp_ns, scale * (rotation * pose.translation_m) + translation_m,
          (rotation * pose.rotation).normalized()};
}

Similarity3 ComputeAlignment(const std::vector<PosePair>& pairs, AlignmentMode mode) {
  if (pairs.empty() && mode != AlignmentMode::kNone) {
    throw std::invalid_argument("there are no pairs of poses to align");
  }
  switch (mode) {
    case AlignmentMode::kNone:
      return {};
    case AlignmentMode::kSe2:
      return FromPlane(Umeyama<2>(pairs, false));
    case AlignmentMode::kSe3:
      return FromSpace(Umeyama<3>(pairs, false));
    case AlignmentMode::kSim3:
      return FromSpace(Umeyama<3>(pairs, true));
    case AlignmentMode::kScale:
      return {Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Umeyama<3>(pairs, true).scale};
    case AlignmentMode::kOrigin:
      return AlignToFirst(pairs.front());
  }
  assert(false);
  return {};
}

std::vector<PosePair> Align(std::vector<PosePair> pairs, const Similarity3& reference_from_estimate) {
  for (PosePair& pair : pairs) {
    pair.estimate = reference_from_estimate * pair.estimate;
  }
  return pairs;
}

}  // namespace floorloc
