// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/initial_lens.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <optional>

namespace floorloc {
namespace {

// Focal lengths to try, in units of the image width.
constexpr std::array kFocalLengths{0.3, 0.5, 0.8, 1.3, 2.2, 4.0};
constexpr int kTrialSteps = 12;
constexpr double kMaxFisheyeAngleRad = 1.45;

// Raw pixel -> plane z = 1, for a lens without distortion.
cv::Point2d OnUnitPlane(const LensAdjustment& problem, const Eigen::Vector2d& raw_px) {
  const double x = (raw_px.x() / problem.width_px - problem.lens[2]) / problem.lens[0];
  const double y = (raw_px.y() / problem.width_px - problem.lens[3]) / problem.lens[1];
  const double r = std::hypot(x, y);
  if (problem.model != DistortionModel::kEquidistant || r < 1e-9) {
    return {x, y};
  }
  const double share = std::tan(std::min(r, kMaxFisheyeAngleRad)) / r;
  return {x * share, y * share};
}

// Pose of a plane in front of the camera from the homography plane -> z = 1 (Zhang 2000).
std::optional<Eigen::Isometry3d> PoseOfPlane(const cv::Mat& homography) {
  Eigen::Matrix3d h;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      h(row, column) = homography.at<double>(row, column);
    }
  }
  const double norm = 0.5 * (h.col(0).norm() + h.col(1).norm());
  if (!h.allFinite() || norm < 1e-12) {
    return std::nullopt;
  }
  h /= std::copysign(norm, h(2, 2));
  Eigen::Matrix3d axes;
  axes << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = h.col(2);
  return pose.linear().determinant() > 0.0 ? std::optional(pose) : std::nullopt;
}

bool LiesInFront(const Eigen::Isometry3d& camera_from_board, const ObservedPoints& view) {
  return std::all_of(view.points_m.begin(), view.points_m.end(),
                     [&](const Eigen::Vector3d& point) { return (camera_from_board * point).z() > 0.0; });
}

bool PlaceBoards(LensAdjustment* problem) {
  problem->poses.clear();
  for (const ObservedPoints& view : problem->views) {
    std::vector<cv::Point2d> board;
    std::vector<cv::Point2d> image;
    for (std::size_t i = 0; i < view.points_m.size(); ++i) {
      board.emplace_back(view.points_m[i].x(), view.points_m[i].y());
      image.push_back(OnUnitPlane(*problem, view.raw_px[i]));
    }
    const cv::Mat homography = cv::findHomography(board, image, 0);
    const std::optional<Eigen::Isometry3d> pose = homography.empty() ? std::nullopt : PoseOfPlane(homography);
    if (!pose || !LiesInFront(*pose, view)) {
      return false;
    }
    problem->poses.push_back(FromIsometry(*pose));
  }
  return true;
}

}  // namespace

bool FindInitialLens(double height_px, LensAdjustment* problem) {
  double best_cost = std::numeric_limits<double>::infinity();
  LensAdjustment best;
  for (const double focal : kFocalLengths) {
    LensAdjustment trial = *problem;
    trial.lens = {focal, focal, 0.5 * (1.0 - 1.0 / trial.width_px), 0.5 * (height_px - 1.0) / trial.width_px};
    if (!PlaceBoards(&trial)) {
      continue;
    }
    const double cost = Adjust(&trial, kTrialSteps, false).cost_px2;
    if (cost < best_cost) {
      best_cost = cost;
      best = std::move(trial);
    }
  }
  if (!std::isfinite(best_cost)) {
    return false;
  }
  *problem = std::move(best);
  return true;
}

}  // namespace floorloc
