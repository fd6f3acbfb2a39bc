// SPDX-License-Identifier: Apache-2.0
#include "core/localization/readout_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/geometry/twist.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

// Position x, y, yaw, logarithm of the scale, read-out.
constexpr int kUnknowns = 5;
using NormalMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using NormalVector = Eigen::Matrix<double, kUnknowns, 1>;

// The matches as they would be seen if all rows were exposed with the middle one.
std::vector<OrientedMatch> PutRowsBack(const ReadoutProblem& problem, double seconds) {
  std::vector<OrientedMatch> moved = problem.matches;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Pose2 by = Pose2::Exp(seconds * problem.share[i] * problem.twist);
    moved[i].source_m = by * moved[i].source_m;
    moved[i].source_angle_rad += by.yaw();
  }
  return moved;
}

struct Fit {
  Pose2 pose;
  double seconds = 0.0;
  std::vector<int> inliers;
};

Fit BestOfGrid(const ReadoutProblem& problem, RegistrationOptions registration, const ReadoutFitOptions& options) {
  registration.candidates = 1;
  // Matches of the first and the last row are inliers when the read-out is off by less than a step.
  const double step_s = std::min(options.max_s, 2.0 * registration.inlier_radius_m / FastestPoint(problem));
  const int steps = static_cast<int>(std::ceil(options.max_s / step_s));
  Fit best;
  const auto improves = [&](int i) {
    const double seconds = options.max_s * i / steps;
    auto candidates = FindPoseCandidates(PutRowsBack(problem, seconds), registration);
    const bool better = !candidates.empty() && candidates.front().inliers.size() > best.inliers.size();
    if (better) {
      best = {candidates.front().target_from_source, seconds, std::move(candidates.front().inliers)};
    }
    return better;
  };
  improves(0);
  const bool is_near =
      static_cast<double>(best.inliers.size()) >= options.near_share * static_cast<double>(problem.matches.size());
  for (const int direction : {-1, 1}) {
    for (int i = 1; i <= steps; ++i) {
      if (!improves(direction * i) && is_near) {
        break;
      }
    }
  }
  return best;
}

struct Normal {
  NormalMatrix information = NormalMatrix::Zero();
  NormalVector gradient = NormalVector::Zero();
  double squares = 0.0;
};

Normal NormalEquations(const ReadoutProblem& problem, const std::vector<OrientedMatch>& moved, const Fit& fit) {
  Normal normal;
  const Eigen::Matrix2d rotation = fit.pose.rotation();
  for (const int index : fit.inliers) {
    const auto i = static_cast<std::size_t>(index);
    const Eigen::Vector2d turned = rotation * moved[i].source_m;
    const Eigen::Vector2d by_time = rotation * VelocityAt(problem.twist, moved[i].source_m) * problem.share[i];
    Eigen::Matrix<double, 2, kUnknowns> jacobian;
    jacobian << 1.0, 0.0, -turned.y(), turned.x(), by_time.x(), 0.0, 1.0, turned.x(), turned.y(), by_time.y();
    const Eigen::Vector2d residual = moved[i].target_m - fit.pose * moved[i].source_m;
    normal.information += jacobian.transpose() * jacobian;
    normal.gradient += jacobian.transpose() * residual;
    normal.squares += residual.squaredNorm();
  }
  return normal;
}

}  // namespace

void ReadoutFitOptions::Check() const {
  RequireOption(max_s > 0.0 && max_s <= 0.2, "max_s must be positive and at most 0.2");
  RequireOption(min_motion_m > 0.0, "min_motion_m must be positive");
  RequireOption(min_inliers >= 8, "min_inliers must be at least 8");
  RequireOption(near_share > 0.0 && near_share <= 1.0, "near_share must be positive and at most 1");
  RequireOption(shear_px >= 0.0, "shear_px must not be negative");
  RequireOption(max_error_m > 0.0, "max_error_m must be positive");
}

double FastestPoint(const ReadoutProblem& problem) {
  double fastest = 0.0;
  for (const OrientedMatch& match : problem.matches) {
    fastest = std::max(fastest, VelocityAt(problem.twist, match.source_m).norm());
  }
  return fastest;
}

bool ShowsReadout(const RectM& roi, const Eigen::Vector3d& twist, const ReadoutFitOptions& options) {
  double fastest = 0.0;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      fastest = std::max(fastest, VelocityAt(twist, {x, y}).norm());
    }
  }
  return fastest * options.max_s >= options.min_motion_m;
}

std::optional<ReadoutMeasurement> FitReadout(const ReadoutProblem& problem, const RegistrationOptions& registration,
                                             const ReadoutFitOptions& options) {
  const double fastest = FastestPoint(problem);
  if (fastest * options.max_s < options.min_motion_m) {
    return std::nullopt;
  }
  Fit fit = BestOfGrid(problem, registration, options);
  // Gauss-Newton, the inliers chosen anew by each step; the scale only takes up errors of the camera's height.
  constexpr int kSteps = 4;
  double sigma_s = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    if (static_cast<int>(fit.inliers.size()) < options.min_inliers) {
      return std::nullopt;
    }
    const Normal normal = NormalEquations(problem, PutRowsBack(problem, fit.seconds), fit);
    const Eigen::LDLT<NormalMatrix> solver(normal.information);
    const NormalVector by = solver.solve(normal.gradient);
    const double freedom = 2.0 * static_cast<double>(fit.inliers.size()) - kUnknowns;
    sigma_s = std::sqrt(solver.solve(NormalVector::Unit(4))(4) * normal.squares / freedom);
    if (!by.allFinite() || !std::isfinite(sigma_s)) {
      return std::nullopt;
    }
    fit.seconds += by(4);
    fit.pose = Pose2(fit.pose.x() + by(0), fit.pose.y() + by(1), fit.pose.yaw() + by(2));
    fit.inliers = FindInliers(PutRowsBack(problem, fit.seconds), fit.pose, registration.inlier_radius_m);
  }
  if (std::abs(fit.seconds) > 1.2 * options.max_s) {
    return std::nullopt;
  }
  return ReadoutMeasurement{fit.seconds, std::hypot(sigma_s, options.shear_px * problem.resolution_m / fastest)};
}

}  // namespace floorloc
