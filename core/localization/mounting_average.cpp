// SPDX-License-Identifier: Apache-2.0
#include "core/localization/mounting_average.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

struct Posterior {
  MountingVector mean;
  MountingMatrix covariance;
  double log_evidence;
};

Posterior PosteriorAt(double level, const MountingMatrix& likelihood, const MountingVector& pull) {
  const Eigen::LDLT<MountingMatrix> lambda(likelihood + PriorInformation(level));
  Posterior posterior;
  posterior.covariance = lambda.solve(MountingMatrix::Identity());
  posterior.mean = posterior.covariance * pull;
  posterior.log_evidence =
      -4.0 * std::log(level) - 0.5 * lambda.vectorD().array().abs().log().sum() + 0.5 * pull.dot(posterior.mean);
  return posterior;
}

}  // namespace

MountingVector MountingStep(const MountingProblem& problem, const MountingVector& unknowns) {
  const MountingMatrix prior = PriorInformation(kLevels.back());
  const MountingMatrix lambda = problem.information / problem.variance + prior;
  const MountingVector step = lambda.ldlt().solve(problem.gradient / problem.variance - prior * unknowns);
  return step.allFinite() ? step : MountingVector::Zero();
}

MountingEstimate MarginalizeMounting(const MountingProblem& problem, const MountingVector& unknowns) {
  const double noise = problem.variance * Inflation(problem);
  const MountingMatrix likelihood = problem.information / noise;
  const MountingVector pull = likelihood * unknowns + problem.gradient / noise;
  std::array<Posterior, kLevels.size()> posteriors;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kLevels.size(); ++k) {
    posteriors[k] = PosteriorAt(kLevels[k], likelihood, pull);
    highest = std::max(highest, posteriors[k].log_evidence);
  }
  double sum = 0.0;
  MountingEstimate estimate{MountingVector::Zero(), MountingMatrix::Zero()};
  for (Posterior& p : posteriors) {
    p.log_evidence = std::exp(p.log_evidence - highest);
    sum += p.log_evidence;
    estimate.mean += p.log_evidence * p.mean;
  }
  estimate.mean /= sum;
  for (const Posterior& p : posteriors) {
    const MountingVector off = p.mean - estimate.mean;
    estimate.covariance += p.log_evidence / sum * (p.covariance + off * off.transpose());
  }
  if (!estimate.mean.allFinite() || !estimate.covariance.allFinite()) {
    return {unknowns, MountingMatrix::Identity()};
  }
  return estimate;
}

}  // namespace floorloc
