// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/lens_adjustment.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

namespace floorloc {
namespace {

// Huber threshold: corners with larger errors lose influence, so that a smudge on the board does not distort the lens.
constexpr double kHuberPx = 1.0;
constexpr double kMinDepthM = 1e-6;

// Smallest eigenvalue of the information matrix of a lens whose parameters are scaled to 1, below which a parameter is
// undetermined.
constexpr double kMinEigenvalue = 1e-13;

// The coefficients of the rational model can cancel each other; this regularisation towards zero, in pixels per unit,
// keeps them small.
constexpr double kRationalPullPx = 0.01;

class ReprojectionError {
 public:
  ReprojectionError(DistortionModel model, double width_px, const Eigen::Vector3d& point_m,
                    const Eigen::Vector2d& raw_px)
      : model_(model), width_px_(width_px), point_m_(point_m), raw_px_(raw_px) {}

  template <typename T>
  bool operator()(const T* lens, const T* pose, T* residual) const {
    const T point[3] = {T(point_m_.x()), T(point_m_.y()), T(point_m_.z())};
    T in_camera[3];
    ceres::AngleAxisRotatePoint(pose, point, in_camera);
    const T z = in_camera[2] + pose[5];
    if (z < T(kMinDepthM)) {
      return false;
    }
    const std::array<T, 2> pixel =
        ProjectThroughLens(model_, lens, T((in_camera[0] + pose[3]) / z), T((in_camera[1] + pose[4]) / z));
    residual[0] = width_px_ * pixel[0] - raw_px_.x();
    residual[1] = width_px_ * pixel[1] - raw_px_.y();
    return true;
  }

 private:
  DistortionModel model_;
  double width_px_;
  Eigen::Vector3d point_m_;
  Eigen::Vector2d raw_px_;
};

class ZeroPrior {
 public:
  template <typename T>
  bool operator()(const T* lens, T* residual) const {
    for (int i = kFirstCoefficient; i < kLensParameters; ++i) {
      residual[i - kFirstCoefficient] = kRationalPullPx * lens[i];
    }
    return true;
  }
};

void AddViews(LensAdjustment* p, ceres::Problem* problem) {
  for (std::size_t v = 0; v < p->views.size(); ++v) {
    const ObservedPoints& view = p->views[v];
    for (std::size_t i = 0; i < view.points_m.size(); ++i) {
      problem->AddResidualBlock(new ceres::AutoDiffCostFunction<ReprojectionError, 2, kLensParameters, 6>(
                                    new ReprojectionError(p->model, p->width_px, view.points_m[i], view.raw_px[i])),
                                new ceres::HuberLoss(kHuberPx), p->lens.data(), p->poses[v].data());
    }
  }
}

// J^T J of all free parameters, those of the lens first.
Eigen::MatrixXd NormalMatrix(LensAdjustment* p, ceres::Problem* problem) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {p->lens.data()};
  for (PoseParameters& pose : p->poses) {
    options.parameter_blocks.push_back(pose.data());
  }
  ceres::CRSMatrix jacobian;
  problem->Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  const auto at = [](const auto& list, int i) { return list[static_cast<std::size_t>(i)]; };
  for (int row = 0; row < jacobian.num_rows; ++row) {
    for (int i = at(jacobian.rows, row); i < at(jacobian.rows, row + 1); ++i) {
      for (int j = at(jacobian.rows, row); j < at(jacobian.rows, row + 1); ++j) {
        normal(at(jacobian.cols, i), at(jacobian.cols, j)) += at(jacobian.values, i) * at(jacobian.values, j);
      }
    }
  }
  return normal;
}

// Inverse of the Schur complement of the lens in the normal matrix; empty when it is numerically singular.
std::optional<LensCovariance> InvertForLens(const Eigen::MatrixXd& normal, const std::vector<int>& free) {
  const auto n = static_cast<Eigen::Index>(free.size());
  const Eigen::Index m = normal.cols() - n;
  const Eigen::MatrixXd lens_pose = normal.topRightCorner(n, m);
  const Eigen::MatrixXd schur =
      normal.topLeftCorner(n, n) - lens_pose * normal.bottomRightCorner(m, m).llt().solve(lens_pose.transpose());
  const Eigen::VectorXd scale = normal.diagonal().head(n).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * schur * scale.asDiagonal());
  if (eigen.info() != Eigen::Success || eigen.eigenvalues().minCoeff() < kMinEigenvalue) {
    return std::nullopt;
  }
  const Eigen::MatrixXd inverse = scale.asDiagonal() * eigen.eigenvectors() *
                                  eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() *
                                  scale.asDiagonal();
  LensCovariance covariance = LensCovariance::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      covariance(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(j)]) = inverse(i, j);
    }
  }
  return covariance;
}

std::vector<int> FreeParameters(const LensAdjustment& p) {
  std::vector<int> free;
  for (int i = 0; i < kLensParameters; ++i) {
    if (std::find(p.fixed.begin(), p.fixed.end(), i) == p.fixed.end()) {
      free.push_back(i);
    }
  }
  return free;
}

}  // namespace

Eigen::Isometry3d ToIsometry(const PoseParameters& pose) {
  Eigen::Matrix3d rotation;
  ceres::AngleAxisToRotationMatrix(pose.data(), rotation.data());
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotation;
  isometry.translation() = Eigen::Vector3d(pose[3], pose[4], pose[5]);
  return isometry;
}

PoseParameters FromIsometry(const Eigen::Isometry3d& pose) {
  PoseParameters parameters{};
  const Eigen::Matrix3d rotation = pose.linear();
  ceres::RotationMatrixToAngleAxis(rotation.data(), parameters.data());
  const Eigen::Vector3d t = pose.translation();
  std::copy(t.data(), t.data() + 3, parameters.begin() + 3);
  return parameters;
}

AdjustmentSummary Adjust(LensAdjustment* p, int max_iterations, bool with_covariance) {
  ceres::Problem problem;
  AddViews(p, &problem);
  const bool all_fixed = p->fixed.size() == kLensParameters;
  if (all_fixed) {
    problem.SetParameterBlockConstant(p->lens.data());
  } else if (!p->fixed.empty()) {
    problem.SetManifold(p->lens.data(), new ceres::SubsetManifold(kLensParameters, p->fixed));
  }
  if (p->model == DistortionModel::kRationalPolynomial && !all_fixed) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ZeroPrior, kLensParameters - kFirstCoefficient, kLensParameters>(new ZeroPrior),
        nullptr, p->lens.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-12;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary solved;
  ceres::Solve(options, &problem, &solved);
  AdjustmentSummary summary;
  summary.cost_px2 = solved.IsSolutionUsable() ? solved.final_cost : std::numeric_limits<double>::infinity();
  if (with_covariance && solved.IsSolutionUsable()) {
    summary.covariance = InvertForLens(NormalMatrix(p, &problem), FreeParameters(*p));
  }
  return summary;
}

std::vector<Eigen::Vector2d> Project(const LensAdjustment& problem, const PoseParameters& pose,
                                     const std::vector<Eigen::Vector3d>& points_m) {
  const Eigen::Isometry3d camera_from_target = ToIsometry(pose);
  std::vector<Eigen::Vector2d> raw_px;
  for (const Eigen::Vector3d& point : points_m) {
    const Eigen::Vector3d p = camera_from_target * point;
    if (p.z() < kMinDepthM) {
      raw_px.push_back(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
      continue;
    }
    const std::array<double, 2> pixel =
        ProjectThroughLens(problem.model, problem.lens.data(), p.x() / p.z(), p.y() / p.z());
    raw_px.emplace_back(problem.width_px * pixel[0], problem.width_px * pixel[1]);
  }
  return raw_px;
}

}  // namespace floorloc
