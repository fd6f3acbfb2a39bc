// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/mounting_average.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace floorloc {
namespace {

// Standard deviations of vibration: radians of each rotation, and share of the camera's height.
constexpr std::array<double, 6> kLevels{2e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3};

// Prior of the start pose. Far looser than what images measure; it regularizes directions that the image does not
// constrain (along stripes), where rounding errors would decide.
constexpr double kLoosePositionM = 0.01;
constexpr double kLooseYawRad = 0.1;

MountingMatrix PriorInformation(double level) {
  MountingMatrix prior = MountingMatrix::Zero();
  prior.diagonal().head<2>().setConstant(1.0 / (kLoosePositionM * kLoosePositionM));
  prior(2, 2) = 1.0 / (kLooseYawRad * kLooseYawRad);
  prior.bottomRightCorner<4, 4>().diagonal().setConstant(1.0 / (level * level));
  return prior;
}

// Inflation of the variance: neighbouring pixels are correlated, so gradients of whole cells scatter more than
// independent residuals would.
double Inflation(const MountingProblem& problem) {
  const Eigen::Matrix3d information = problem.information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d scatter = problem.scatter.topLeftCorner<3, 3>();
  double ratio = information.ldlt().solve(scatter).trace() / (3.0 * problem.variance);
  if (problem.cells > 0) {
    // Degrees of freedom: the unknowns were fitted to the same cells, so few cells scatter too little.
    ratio *= static_cast<double>(problem.cells) /
             std::max(1, problem.cells - static_cast<int>(MountingVector::SizeAtCompileTime));
  }
  return std::isfinite(ratio) ? std::max(1.0, ratio) : 1.0;
}

// The calibration's error relative to its standard deviation: a log-normal distribution of a factor of two, by the
// weights of the binomial distribution.
struct CalibrationLevel {
  double factor;
  double probability;
};
constexpr std::array<CalibrationLevel, 5> kCalibrationLevels{
    {{0.25, 1.0 / 16.0}, {0.5, 4.0 / 16.0}, {1.0, 6.0 / 16.0}, {2.0, 4.0 / 16.0}, {4.0, 1.0 / 16.0}}};

// Of one mode, so that all modes together displace a corner by 1 px: at a corner of a 4:3 image the modes' squares add
// up to 5.9.
constexpr double kModeSigmaPx = 0.41;

// For a calibration that is taken as exact: far below what images measure.
constexpr double kExactPx = 1e-6;

constexpr int kMotions = MountingVector::SizeAtCompileTime;
constexpr int kUnknowns = kMotions + kCalibrationModes;
using FullVector = Eigen::Matrix<double, kUnknowns, 1>;
using FullMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// Likelihood of motion, mounting and calibration: information matrix and information vector.
struct Likelihood {
  FullMatrix information;
  FullVector pull;
};

// Schur complement of the motion of the rows, whose prior is the same at all levels.
void MarginalizeReadout(const MountingProblem& problem, const MountingVector& unknowns, double noise,
                        Likelihood* likelihood) {
  const Eigen::Matrix<double, kUnknowns, 3> cross = problem.by_readout / noise;
  Eigen::Matrix3d own = problem.readout_information / noise;
  own.diagonal() += problem.readout_sigma.cwiseAbs2().cwiseInverse();
  const Eigen::Vector3d pull = problem.readout_gradient / noise + cross.topRows<kMotions>().transpose() * unknowns;
  const Eigen::Matrix<double, 3, kUnknowns> gain = own.ldlt().solve(cross.transpose());
  likelihood->information -= cross * gain;
  likelihood->pull -= gain.transpose() * pull;
}

Likelihood MakeLikelihood(const MountingProblem& problem, const MountingVector& unknowns) {
  const double noise = problem.variance * Inflation(problem);
  Likelihood likelihood;
  likelihood.information << problem.information, problem.by_calibration, problem.by_calibration.transpose(),
      problem.calibration_information;
  likelihood.information /= noise;
  likelihood.pull << problem.gradient, problem.calibration_gradient;
  likelihood.pull = likelihood.pull / noise + likelihood.information.leftCols<kMotions>() * unknowns;
  if (!problem.readout_sigma.isZero()) {
    MarginalizeReadout(problem, unknowns, noise, &likelihood);
  }
  return likelihood;
}

// Gaussian prior of motion, mounting and calibration.
struct Prior {
  FullMatrix information = FullMatrix::Zero();
  FullVector pull = FullVector::Zero();  // information * mean
  double log_norm = 0.0;                 // logarithm of its value at 0, up to a constant
};

// calibration_px: standard deviation of each mode.
Prior IndependentPrior(double level, double calibration_px) {
  Prior prior;
  prior.information.topLeftCorner<kMotions, kMotions>() = PriorInformation(level);
  prior.information.diagonal().tail<kCalibrationModes>().setConstant(1.0 / (calibration_px * calibration_px));
  prior.log_norm = -4.0 * std::log(level) - kCalibrationModes * std::log(calibration_px);
  return prior;
}

constexpr int kMounted = 4 + kCalibrationModes;
using MountedVector = Eigen::Matrix<double, kMounted, 1>;
using MountedMatrix = Eigen::Matrix<double, kMounted, kMounted>;

// Mounting and calibration (rows) by the camera's constant errors (columns).
Eigen::Matrix<double, kMounted, kCameraErrors> MountedFromErrors() {
  Eigen::Matrix<double, kMounted, kCameraErrors> select = Eigen::Matrix<double, kMounted, kCameraErrors>::Zero();
  select(0, 0) = select(1, 1) = select(3, 2) = 1.0;
  select.bottomRightCorner<kCalibrationModes, kCalibrationModes>().setIdentity();
  return select;
}

Prior PriorOf(double level, const CameraPrior& camera) {
  const auto select = MountedFromErrors();
  MountedMatrix covariance = select * camera.covariance * select.transpose();
  covariance.diagonal().head<4>().array() += level * level;
  const Eigen::LLT<MountedMatrix> factor(covariance);
  const MountedMatrix information = factor.solve(MountedMatrix::Identity());
  const MountedVector mean = select * camera.mean;
  Prior prior = IndependentPrior(level, 1.0);
  prior.information.bottomRightCorner<kMounted, kMounted>() = information;
  prior.pull.tail<kMounted>() = information * mean;
  prior.log_norm = -factor.matrixLLT().diagonal().array().log().sum() - 0.5 * mean.dot(prior.pull.tail<kMounted>());
  return prior;
}

struct Posterior {
  double level;
  MountingVector mean;
  MountingMatrix covariance;
  double log_evidence;
};

Posterior PosteriorAt(double level, const Prior& prior, const Likelihood& likelihood) {
  const Eigen::LLT<FullMatrix> lambda(likelihood.information + prior.information);
  const FullVector pull = likelihood.pull + prior.pull;
  const FullVector mean = lambda.solve(pull);
  Posterior posterior;
  posterior.level = level;
  posterior.mean = mean.head<kMotions>();
  posterior.covariance = lambda.solve(FullMatrix::Identity().leftCols<kMotions>()).topRows<kMotions>();
  posterior.log_evidence = prior.log_norm - lambda.matrixLLT().diagonal().array().log().sum() + 0.5 * pull.dot(mean);
  return posterior;
}

std::vector<Posterior> PosteriorsOf(const Likelihood& likelihood, double calibration_sigma_px) {
  std::vector<Posterior> posteriors;
  for (const double level : kLevels) {
    if (calibration_sigma_px <= 0.0) {
      posteriors.push_back(PosteriorAt(level, IndependentPrior(level, kExactPx), likelihood));
      continue;
    }
    for (const CalibrationLevel& calibration : kCalibrationLevels) {
      const double sigma_px = kModeSigmaPx * calibration.factor * calibration_sigma_px;
      posteriors.push_back(PosteriorAt(level, IndependentPrior(level, sigma_px), likelihood));
      posteriors.back().log_evidence += std::log(calibration.probability);
    }
  }
  return posteriors;
}

// Weighted by their evidence. unknowns: the estimate when they are not finite.
MountingEstimate Average(std::vector<Posterior> posteriors, const MountingVector& unknowns) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const Posterior& p : posteriors) {
    highest = std::max(highest, p.log_evidence);
  }
  double sum = 0.0;
  MountingEstimate estimate{MountingVector::Zero(), MountingMatrix::Zero(), 0.0};
  for (Posterior& p : posteriors) {
    p.log_evidence = std::exp(p.log_evidence - highest);
    sum += p.log_evidence;
    estimate.mean += p.log_evidence * p.mean;
    estimate.vibration += p.log_evidence * p.level;
  }
  estimate.mean /= sum;
  estimate.vibration /= sum;
  for (const Posterior& p : posteriors) {
    const MountingVector off = p.mean - estimate.mean;
    estimate.covariance += p.log_evidence / sum * (p.covariance + off * off.transpose());
  }
  if (!estimate.mean.allFinite() || !estimate.covariance.allFinite()) {
    return {unknowns, MountingMatrix::Identity(), kLevels.back()};
  }
  return estimate;
}

}  // namespace

MountingVector MountingStep(const MountingProblem& problem, const MountingVector& unknowns) {
  const MountingMatrix prior = PriorInformation(kLevels.back());
  const MountingMatrix lambda = problem.information / problem.variance + prior;
  const MountingVector step = lambda.ldlt().solve(problem.gradient / problem.variance - prior * unknowns);
  return step.allFinite() ? step : MountingVector::Zero();
}

MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns,
                                     double calibration_sigma_px) {
  return Average(PosteriorsOf(MakeLikelihood(problem, unknowns), calibration_sigma_px), unknowns);
}

MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns,
                                     const CameraPrior& camera) {
  const Likelihood likelihood = MakeLikelihood(problem, unknowns);
  std::vector<Posterior> posteriors;
  for (const double level : kLevels) {
    posteriors.push_back(PosteriorAt(level, PriorOf(level, camera), likelihood));
  }
  return Average(std::move(posteriors), unknowns);
}

CameraEvidence EvidenceOfCamera(const MountingProblem& problem, const MountingVector& unknowns, double vibration,
                                double mosaic_sigma_px) {
  const Likelihood likelihood = MakeLikelihood(problem, unknowns);
  // Motion, mounting and calibration of this frame are the camera's errors plus what changes from frame to frame.
  Eigen::Matrix<double, kUnknowns, kCameraErrors> by_errors = Eigen::Matrix<double, kUnknowns, kCameraErrors>::Zero();
  by_errors.bottomRows<kMounted>() = MountedFromErrors();
  const FullMatrix changing =
      likelihood.information + IndependentPrior(vibration, kModeSigmaPx * mosaic_sigma_px).information;
  const Eigen::LLT<FullMatrix> factor(changing);
  const Eigen::Matrix<double, kUnknowns, kCameraErrors> cross = likelihood.information * by_errors;
  CameraEvidence evidence;
  evidence.information = by_errors.transpose() * cross - cross.transpose() * factor.solve(cross);
  evidence.pull = by_errors.transpose() * likelihood.pull - cross.transpose() * factor.solve(likelihood.pull);
  if (!evidence.information.allFinite() || !evidence.pull.allFinite()) {
    return {};
  }
  return evidence;
}

}  // namespace floorloc
