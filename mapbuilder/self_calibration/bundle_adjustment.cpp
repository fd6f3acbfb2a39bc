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
#include "mapbuilder/self_calibration/bundle_parameters.h"
#include "mapbuilder/self_calibration/bundle_residuals.h"

namespace floorloc {
namespace {

class Adjuster {
 public:
  explicit Adjuster(Bundle* bundle) : bundle_(*bundle), parameters_(*bundle) {}

  BundleSummary Run() {
    BundleSummary result;
    result.rms_before_m = ObservationRms();
    AddObservations();
    AddAbsoluteConstraints();
    AddPriors();
    SetConstantParameters();
    result.converged = Solve();
    parameters_.CopyTo(&bundle_);
    result.rms_after_m = ObservationRms();
    result.camera_covariance = CameraCovariances();
    return result;
  }

 private:
  double* PoseOf(int frame) { return parameters_.Pose(static_cast<std::size_t>(frame)); }
  double* TiltOf(int frame) { return parameters_.Tilt(static_cast<std::size_t>(frame)); }
  int CameraNumber(int frame) const { return bundle_.camera_of_frame[static_cast<std::size_t>(frame)]; }
  double* CameraOf(int frame) { return parameters_.Camera(static_cast<std::size_t>(CameraNumber(frame))); }
  CameraAdjustment EarlierChange(std::size_t camera) const {
    return bundle_.earlier_change.empty() ? CameraAdjustment(CameraAdjustment::Zero()) : bundle_.earlier_change[camera];
  }
  static ceres::LossFunction* Robust() { return new ceres::CauchyLoss(kCauchyScale); }

  void AddObservations();
  void AddAbsoluteConstraints();
  void AddDistance(const ObservedDistance& distance);
  void AddPriors();
  void AddCameraPrior(std::size_t camera);
  void SetConstantParameters();
  bool Solve();
  double ObservationRms();
  std::vector<CameraCovariance> CameraCovariances();

  Bundle& bundle_;
  BundleParameters parameters_;
  ceres::Problem problem_;
};

void Adjuster::AddObservations() {
  for (std::size_t t = 0; t < bundle_.tracks.size(); ++t) {
    for (const Observation& observation : bundle_.tracks[t].observations) {
      problem_.AddResidualBlock(new ObservationError(observation, bundle_.observation_sigma_m), Robust(),
                                PoseOf(observation.frame), CameraOf(observation.frame), TiltOf(observation.frame),
                                parameters_.Point(t));
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
  for (std::size_t c = 0; c < bundle_.cameras.size(); ++c) {
    if (problem_.HasParameterBlock(parameters_.Camera(c))) {
      AddCameraPrior(c);
    }
  }
  const Eigen::Vector3d tilt_sigma(bundle_.prior.tilt_rad, bundle_.prior.tilt_rad, bundle_.prior.tilt_height);
  for (std::size_t i = 0; i < bundle_.tilts.size(); ++i) {
    double* tilt = parameters_.Tilt(i);
    if (!problem_.HasParameterBlock(tilt)) {
      continue;
    }
    if (bundle_.prior.tilt_rad <= 0.0) {
      problem_.SetParameterBlockConstant(tilt);
    } else {
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<ZeroPrior<kTiltUnknowns>, kTiltUnknowns, kTiltUnknowns>(
                                    new ZeroPrior<kTiltUnknowns>{Eigen::Vector3d::Zero(), tilt_sigma}),
                                nullptr, tilt);
    }
  }
}

void Adjuster::AddCameraPrior(std::size_t camera) {
  double* block = parameters_.Camera(camera);
  CameraAdjustment sigma;
  std::vector<int> known;
  for (int i = 0; i < kCameraUnknowns; ++i) {
    const double prior = bundle_.prior.cameras[camera][static_cast<std::size_t>(i)];
    sigma[i] = prior > 0.0 ? prior : 1.0;
    if (prior <= 0.0) {
      known.push_back(i);
    }
  }
  if (static_cast<int>(known.size()) == kCameraUnknowns) {
    problem_.SetParameterBlockConstant(block);
    return;
  }
  problem_.AddResidualBlock(
      new ceres::AutoDiffCostFunction<ZeroPrior<kCameraUnknowns>, kCameraUnknowns, kCameraUnknowns>(
          new ZeroPrior<kCameraUnknowns>{EarlierChange(camera), sigma}),
      nullptr, block);
  if (!known.empty()) {
    problem_.SetManifold(block, new ceres::SubsetManifold(kCameraUnknowns, known));
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
  for (std::size_t t = 0; t < bundle_.tracks.size(); ++t) {
    options.linear_solver_ordering->AddElementToGroup(parameters_.Point(t), 0);
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
std::vector<CameraCovariance> Adjuster::CameraCovariances() {
  std::vector<CameraCovariance> covariances(bundle_.cameras.size(), CameraCovariance::Zero());
  std::vector<std::pair<std::size_t, int>> columns;  // camera, unknown: the first columns of the Jacobian
  ceres::Problem::EvaluateOptions options;
  for (std::size_t camera = 0; camera < bundle_.cameras.size(); ++camera) {
    double* block = parameters_.Camera(camera);
    if (!problem_.HasParameterBlock(block) || problem_.IsParameterBlockConstant(block)) {
      continue;
    }
    options.parameter_blocks.push_back(block);
    for (int i = 0; i < kCameraUnknowns; ++i) {
      if (bundle_.prior.cameras[camera][static_cast<std::size_t>(i)] > 0.0) {
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
    return covariances;
  }
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(), crs.cols.data(),
      crs.values.data());
  const Eigen::SparseMatrix<double> normal = jacobian.transpose() * jacobian;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) {
    return covariances;
  }
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Eigen::VectorXd inverse = solver.solve(Eigen::VectorXd::Unit(crs.num_cols, static_cast<Eigen::Index>(k)));
    const auto [camera, unknown] = columns[k];
    for (std::size_t other = 0; other < columns.size(); ++other) {
      if (columns[other].first == camera) {
        covariances[camera](columns[other].second, unknown) = inverse[static_cast<Eigen::Index>(other)];
      }
    }
  }
  return covariances;
}

}  // namespace

BundleSummary AdjustBundle(Bundle* bundle) { return Adjuster(bundle).Run(); }

}  // namespace floorloc
