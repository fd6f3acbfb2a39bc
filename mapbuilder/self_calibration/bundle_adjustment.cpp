// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/bundle_adjustment.h"

#include <ceres/ceres.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "mapbuilder/placement/pose_graph_factors.h"

namespace floorloc {
namespace {

constexpr int kTiltUnknowns = 3;

// Predicted map position of an observation.
template <typename T>
Eigen::Matrix<T, 2, 1> InMap(const Observation& observation, const T* pose, const T* camera, const T* tilt) {
  const Eigen::Map<const Eigen::Matrix<T, kCameraUnknowns, 1>> c(camera);
  const Eigen::Map<const Eigen::Matrix<T, kTiltUnknowns, 1>> t(tilt);
  const Eigen::Matrix<T, 2, 1> p =
      observation.point_in_base_m.cast<T>() + observation.by_camera.cast<T>() * c + observation.by_tilt.cast<T>() * t;
  const T cosine = ceres::cos(pose[2]);
  const T sine = ceres::sin(pose[2]);
  return {cosine * p[0] - sine * p[1] + pose[0], sine * p[0] + cosine * p[1] + pose[1]};
}

// Of an observation of an unknown floor point: pose, camera, tilt, point. Errors arise in the image, so they scale with
// the floor's scale; with a constant sigma, shrinking the floor would reduce the cost. Analytic, since a large survey
// has hundred thousands of them.
class ObservationError : public ceres::SizedCostFunction<2, 3, kCameraUnknowns, kTiltUnknowns, 2> {
 public:
  ObservationError(const Observation& observation, double sigma_m) : observation_(observation), sigma_m_(sigma_m) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* pose = parameters[0];
    const Eigen::Map<const CameraAdjustment> camera(parameters[1]);
    const Eigen::Map<const Eigen::Vector3d> tilt(parameters[2]);
    const Eigen::Map<const Eigen::Vector2d> point(parameters[3]);
    const Eigen::Matrix2d rotation = Pose2(0.0, 0.0, pose[2]).rotation();
    const Eigen::Vector2d in_base =
        observation_.point_in_base_m + observation_.by_camera * camera + observation_.by_tilt * tilt;
    const Eigen::Vector2d arm = rotation * in_base;
    const double scale = 1.0 + camera[kHeight] - camera[kFocal] + tilt[2];
    const double weight = 1.0 / (sigma_m_ * scale);
    const Eigen::Vector2d residual = weight * (arm + Eigen::Vector2d(pose[0], pose[1]) - point);
    Eigen::Map<Eigen::Vector2d> out(residuals);
    out = residual;
    if (jacobians == nullptr) {
      return true;
    }
    const Eigen::Vector2d by_scale = -residual / scale;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> j(jacobians[0]);
      j << weight, 0.0, -weight * arm.y(), 0.0, weight, weight * arm.x();
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, kCameraUnknowns, Eigen::RowMajor>> j(jacobians[1]);
      j = weight * rotation * observation_.by_camera;
      j.col(kHeight) += by_scale;
      j.col(kFocal) -= by_scale;
    }
    if (jacobians[2] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, kTiltUnknowns, Eigen::RowMajor>> j(jacobians[2]);
      j = weight * rotation * observation_.by_tilt;
      j.col(2) += by_scale;
    }
    if (jacobians[3] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> j(jacobians[3]);
      j = -weight * Eigen::Matrix2d::Identity();
    }
    return true;
  }

 private:
  static constexpr int kHeight = static_cast<int>(CameraUnknown::kHeight);
  static constexpr int kFocal = static_cast<int>(CameraUnknown::kFocal);

  Observation observation_;
  double sigma_m_;
};

struct ControlError {
  ObservedControlPoint point;

  template <typename T>
  bool operator()(const T* pose, const T* camera, const T* tilt, T* residual) const {
    const Eigen::Matrix<T, 2, 1> p = InMap(point.observation, pose, camera, tilt);
    residual[0] = (p[0] - T(point.point_in_map_m.x())) / T(point.sigma_m);
    residual[1] = (p[1] - T(point.point_in_map_m.y())) / T(point.sigma_m);
    return true;
  }
};

struct DistanceError {
  ObservedDistance distance;

  // Ceres gives a residual one argument per parameter block.
  template <typename T>  // NOLINTNEXTLINE(readability-function-size)
  bool operator()(const T* pose_a, const T* camera_a, const T* tilt_a, const T* pose_b, const T* camera_b,
                  const T* tilt_b, T* residual) const {
    return Measure(InMap(distance.first, pose_a, camera_a, tilt_a), InMap(distance.second, pose_b, camera_b, tilt_b),
                   residual);
  }
  // For two frames of one camera: a Ceres residual must not use a parameter block twice.
  template <typename T>  // NOLINTNEXTLINE(readability-function-size)
  bool operator()(const T* pose_a, const T* tilt_a, const T* pose_b, const T* tilt_b, const T* camera,
                  T* residual) const {
    return Measure(InMap(distance.first, pose_a, camera, tilt_a), InMap(distance.second, pose_b, camera, tilt_b),
                   residual);
  }

 private:
  template <typename T>
  bool Measure(const Eigen::Matrix<T, 2, 1>& a, const Eigen::Matrix<T, 2, 1>& b, T* residual) const {
    const T dx = a[0] - b[0];
    const T dy = a[1] - b[1];
    residual[0] = (ceres::sqrt(dx * dx + dy * dy) - T(distance.distance_m)) / T(distance.sigma_m);
    return true;
  }
};

struct DistanceWithinFrame {
  ObservedDistance distance;

  template <typename T>
  bool operator()(const T* camera, const T* tilt, T* residual) const {
    const T still[3] = {T(0.0), T(0.0), T(0.0)};
    return DistanceError{distance}(still, tilt, still, tilt, camera, residual);
  }
};

// Zero-mean Gaussian prior on N unknowns plus a given offset.
template <int N>
struct ZeroPrior {
  Eigen::Matrix<double, N, 1> offset;
  Eigen::Matrix<double, N, 1> sigma;

  template <typename T>
  bool operator()(const T* value, T* residual) const {
    for (int i = 0; i < N; ++i) {
      residual[i] = (T(offset[i]) + value[i]) / T(sigma[i]);
    }
    return true;
  }
};

class Adjuster {
 public:
  explicit Adjuster(Bundle* bundle) : bundle_(*bundle) {
    for (const Pose2& pose : bundle_.map_from_base) {
      poses_.push_back({pose.x(), pose.y(), pose.yaw()});
    }
  }

  BundleSummary Run() {
    BundleSummary result;
    result.rms_before_m = ObservationRms();
    AddObservations();
    AddAbsoluteConstraints();
    AddPriors();
    SetConstantParameters();
    result.converged = Solve();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      bundle_.map_from_base[i] = Pose2(poses_[i][0], poses_[i][1], poses_[i][2]);
    }
    result.rms_after_m = ObservationRms();
    result.camera_sigma = CameraSigmas();
    return result;
  }

 private:
  double* PoseOf(int frame) { return poses_[static_cast<std::size_t>(frame)].data(); }
  double* TiltOf(int frame) { return bundle_.tilts[static_cast<std::size_t>(frame)].data(); }
  int CameraNumber(int frame) const { return bundle_.camera_of_frame[static_cast<std::size_t>(frame)]; }
  double* CameraOf(int frame) { return bundle_.cameras[static_cast<std::size_t>(CameraNumber(frame))].data(); }
  CameraAdjustment EarlierChange(std::size_t camera) const {
    return bundle_.earlier_change.empty() ? CameraAdjustment(CameraAdjustment::Zero()) : bundle_.earlier_change[camera];
  }
  static ceres::LossFunction* Robust() { return new ceres::CauchyLoss(kCauchyScale); }

  void AddObservations();
  void AddAbsoluteConstraints();
  void AddDistance(const ObservedDistance& distance);
  void AddPriors();
  void SetConstantParameters();
  bool Solve();
  double ObservationRms();
  std::vector<CameraAdjustment> CameraSigmas();

  Bundle& bundle_;
  PoseParameters poses_;
  ceres::Problem problem_;
};

void Adjuster::AddObservations() {
  for (ObservedTrack& track : bundle_.tracks) {
    for (const Observation& observation : track.observations) {
      problem_.AddResidualBlock(new ObservationError(observation, bundle_.observation_sigma_m), Robust(),
                                PoseOf(observation.frame), CameraOf(observation.frame), TiltOf(observation.frame),
                                track.position_m.data());
    }
  }
}

void Adjuster::AddAbsoluteConstraints() {
  for (const ObservedControlPoint& point : bundle_.control_points) {
    const int frame = point.observation.frame;
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ControlError, 2, 3, kCameraUnknowns, kTiltUnknowns>(new ControlError{point}),
        Robust(), PoseOf(frame), CameraOf(frame), TiltOf(frame));
  }
  for (const ObservedDistance& distance : bundle_.distances) {
    AddDistance(distance);
  }
  for (const PosePriorFactor& prior : bundle_.priors) {
    AddPosePrior(prior, PoseOf(prior.frame), &problem_);
  }
  for (const Link& link : bundle_.odometry) {
    AddBetween(link, Robust(), &poses_, &problem_);
  }
}

// If both points are in one frame, its pose cancels out.
void Adjuster::AddDistance(const ObservedDistance& distance) {
  const int a = distance.first.frame;
  const int b = distance.second.frame;
  if (a == b) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<DistanceWithinFrame, 1, kCameraUnknowns, kTiltUnknowns>(
                                  new DistanceWithinFrame{distance}),
                              Robust(), CameraOf(a), TiltOf(a));
  } else if (CameraNumber(a) == CameraNumber(b)) {
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<DistanceError, 1, 3, kTiltUnknowns, 3, kTiltUnknowns, kCameraUnknowns>(
            new DistanceError{distance}),
        Robust(), PoseOf(a), TiltOf(a), PoseOf(b), TiltOf(b), CameraOf(a));
  } else {
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<DistanceError, 1, 3, kCameraUnknowns, kTiltUnknowns, 3, kCameraUnknowns,
                                        kTiltUnknowns>(new DistanceError{distance}),
        Robust(), PoseOf(a), CameraOf(a), TiltOf(a), PoseOf(b), CameraOf(b), TiltOf(b));
  }
}

// Holds exactly known parameters constant and adds priors to the others.
void Adjuster::AddPriors() {
  CameraAdjustment sigma;
  std::vector<int> known;
  for (int i = 0; i < kCameraUnknowns; ++i) {
    const double prior = bundle_.prior.camera[static_cast<std::size_t>(i)];
    sigma[i] = prior > 0.0 ? prior : 1.0;
    if (prior <= 0.0) {
      known.push_back(i);
    }
  }
  for (std::size_t c = 0; c < bundle_.cameras.size(); ++c) {
    CameraAdjustment& camera = bundle_.cameras[c];
    if (!problem_.HasParameterBlock(camera.data())) {
      continue;
    }
    if (static_cast<int>(known.size()) == kCameraUnknowns) {
      problem_.SetParameterBlockConstant(camera.data());
      continue;
    }
    problem_.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ZeroPrior<kCameraUnknowns>, kCameraUnknowns, kCameraUnknowns>(
            new ZeroPrior<kCameraUnknowns>{EarlierChange(c), sigma}),
        nullptr, camera.data());
    if (!known.empty()) {
      problem_.SetManifold(camera.data(), new ceres::SubsetManifold(kCameraUnknowns, known));
    }
  }
  const Eigen::Vector3d tilt_sigma(bundle_.prior.tilt_rad, bundle_.prior.tilt_rad, bundle_.prior.tilt_height);
  for (Eigen::Vector3d& tilt : bundle_.tilts) {
    if (!problem_.HasParameterBlock(tilt.data())) {
      continue;
    }
    if (bundle_.prior.tilt_rad <= 0.0) {
      problem_.SetParameterBlockConstant(tilt.data());
    } else {
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ZeroPrior<kTiltUnknowns>, kTiltUnknowns, kTiltUnknowns>(
                                    new ZeroPrior<kTiltUnknowns>{Eigen::Vector3d::Zero(), tilt_sigma}),
                                nullptr, tilt.data());
    }
  }
}

void Adjuster::SetConstantParameters() {
  for (const int frame : bundle_.fixed) {
    if (problem_.HasParameterBlock(PoseOf(frame))) {
      problem_.SetParameterBlockConstant(PoseOf(frame));
    }
  }
}

bool Adjuster::Solve() {
  ceres::Solver::Options options = RepeatableSolverOptions();
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 30;
  options.function_tolerance = 1e-5;
  options.initial_trust_region_radius = 1e10;  // damping would hold the scale, which few factors determine
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (ObservedTrack& track : bundle_.tracks) {
    options.linear_solver_ordering->AddElementToGroup(track.position_m.data(), 0);
  }
  std::vector<double*> blocks;
  problem_.GetParameterBlocks(&blocks);
  for (double* block : blocks) {
    if (!options.linear_solver_ordering->IsMember(block)) {
      options.linear_solver_ordering->AddElementToGroup(block, 1);
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  return summary.IsSolutionUsable();
}

double Adjuster::ObservationRms() {
  double sum = 0.0;
  int count = 0;
  for (const ObservedTrack& track : bundle_.tracks) {
    std::vector<Eigen::Vector2d> positions;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Observation& observation : track.observations) {
      positions.push_back(InMap<double>(observation, PoseOf(observation.frame), CameraOf(observation.frame),
                                        TiltOf(observation.frame)));
      mean += positions.back() / static_cast<double>(track.observations.size());
    }
    for (const Eigen::Vector2d& position : positions) {
      sum += (position - mean).squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

// From the inverse of the full normal matrix; floor points are eliminated first (Schur complement), since their blocks
// are diagonal.
std::vector<CameraAdjustment> Adjuster::CameraSigmas() {
  std::vector<CameraAdjustment> sigmas(bundle_.cameras.size(), CameraAdjustment::Zero());
  std::vector<std::pair<std::size_t, int>> columns;  // camera, unknown: the first columns of the Jacobian
  ceres::Problem::EvaluateOptions options;
  for (std::size_t camera = 0; camera < bundle_.cameras.size(); ++camera) {
    double* block = bundle_.cameras[camera].data();
    if (!problem_.HasParameterBlock(block) || problem_.IsParameterBlockConstant(block)) {
      continue;
    }
    options.parameter_blocks.push_back(block);
    for (int i = 0; i < kCameraUnknowns; ++i) {
      if (bundle_.prior.camera[static_cast<std::size_t>(i)] > 0.0) {
        columns.emplace_back(camera, i);
      }
    }
  }
  const std::size_t cameras = options.parameter_blocks.size();
  std::vector<double*> blocks;
  problem_.GetParameterBlocks(&blocks);
  std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(options.parameter_blocks), [&](double* block) {
    const auto end = options.parameter_blocks.begin() + static_cast<std::ptrdiff_t>(cameras);
    return !problem_.IsParameterBlockConstant(block) && std::find(options.parameter_blocks.begin(), end, block) == end;
  });
  ceres::CRSMatrix crs;
  if (columns.empty() || !problem_.Evaluate(options, nullptr, nullptr, nullptr, &crs)) {
    return sigmas;
  }
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(), crs.cols.data(),
      crs.values.data());
  const Eigen::SparseMatrix<double> normal = jacobian.transpose() * jacobian;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) {
    return sigmas;
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd inverse = solver.solve(Eigen::VectorXd::Unit(crs.num_cols, column));
    sigmas[columns[k].first][columns[k].second] = std::sqrt(std::max(0.0, inverse[column]));
  }
  return sigmas;
}

}  // namespace

BundleSummary AdjustBundle(Bundle* bundle) { return Adjuster(bundle).Run(); }

}  // namespace floorloc
