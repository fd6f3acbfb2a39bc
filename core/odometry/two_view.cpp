// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/two_view.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace floorloc {
namespace {

constexpr int kMinAgreeing = 8;
constexpr double kConfidence = 0.9999;
constexpr double kHorizon = 1e4;  // in baselines; beyond its default of 50 cv::recoverPose would reject points

Eigen::Vector3d Ray(const Eigen::Vector2d& point) { return point.homogeneous().normalized(); }

Eigen::Matrix3d Kabsch(const std::vector<PointPair>& pairs, const std::vector<std::size_t>& subset) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const std::size_t i : subset) {
    correlation += Ray(pairs[i].second) * Ray(pairs[i].first).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d skew;
  skew << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return skew;
}

// x -> Exp(rotation) * pose * x + shift, the change in the camera's own frame.
Eigen::Isometry3d Moved(const Eigen::Isometry3d& pose, const Eigen::Matrix<double, 6, 1>& change) {
  const Eigen::Vector3d turn = change.tail<3>();
  Eigen::Isometry3d moved = pose;
  if (turn.norm() > 0.0) {
    moved.prerotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  moved.pretranslate(Eigen::Vector3d(change.head<3>()));
  return moved;
}

// Normal equations of the reprojection errors.
struct PoseEquations {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  double cost = 0.0;
  int agreeing = 0;
};

PoseEquations Linearize(const std::vector<LandmarkObservation>& landmarks, const Eigen::Isometry3d& pose,
                        double noise) {
  constexpr double kBehindCost = 100.0;
  PoseEquations sum;
  for (const LandmarkObservation& landmark : landmarks) {
    const Eigen::Vector3d x = pose * landmark.in_first;
    if (x.z() <= 1e-9) {
      sum.cost += kBehindCost;
      continue;
    }
    const Eigen::Vector2d error = (x.hnormalized() - landmark.in_second) / noise;
    const double size = error.norm();
    const double weight = size <= 1.0 ? 1.0 : 1.0 / size;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0 / x.z(), 0.0, -x.x() / (x.z() * x.z()), 0.0, 1.0 / x.z(), -x.y() / (x.z() * x.z());
    Eigen::Matrix<double, 2, 6> jacobian;
    jacobian << projection / noise, -projection * Skew(x) / noise;
    sum.information += weight * jacobian.transpose() * jacobian;
    sum.gradient += weight * jacobian.transpose() * error;
    sum.cost += size <= 1.0 ? 0.5 * size * size : size - 0.5;
    sum.agreeing += size <= 3.0 ? 1 : 0;
  }
  return sum;
}

}  // namespace

RotationFit FitRotation(const std::vector<PointPair>& pairs) {
  RotationFit fit;
  std::vector<std::size_t> subset(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    subset[i] = i;
  }
  std::vector<double> residuals(pairs.size());
  for (int round = 0; round < 3; ++round) {
    fit.second_from_first = Kabsch(pairs, subset);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      residuals[i] = Angle(Ray(pairs[i].second), fit.second_from_first * Ray(pairs[i].first));
    }
    std::vector<double> sorted = residuals;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    fit.parallax_rad = *middle;
    subset.clear();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (residuals[i] <= fit.parallax_rad) {
        subset.push_back(i);
      }
    }
  }
  return fit;
}

std::optional<TwoViewMotion> EstimateMotion(const std::vector<PointPair>& pairs, double noise) {
  if (static_cast<int>(pairs.size()) < kMinAgreeing) {
    return std::nullopt;
  }
  std::vector<cv::Point2d> first, second;
  for (const PointPair& pair : pairs) {
    first.emplace_back(pair.first.x(), pair.first.y());
    second.emplace_back(pair.second.x(), pair.second.y());
  }
  cv::Mat mask;
  const cv::Mat camera = cv::Mat::eye(3, 3, CV_64F);
  const cv::Mat essential = cv::findEssentialMat(first, second, camera, cv::RANSAC, kConfidence, noise, mask);
  if (essential.rows != 3 || essential.cols != 3) {
    return std::nullopt;
  }
  cv::Mat rotation, translation;
  TwoViewMotion motion;
  motion.inlier_count = cv::recoverPose(essential, first, second, camera, rotation, translation, kHorizon, mask);
  if (motion.inlier_count < kMinAgreeing) {
    return std::nullopt;
  }
  cv::cv2eigen(rotation, motion.second_from_first);
  cv::cv2eigen(translation, motion.direction);
  for (int i = 0; i < mask.rows; ++i) {
    motion.inliers.push_back(mask.at<unsigned char>(i) != 0);
  }
  return motion;
}

std::optional<double> TriangulateDepth(const PointPair& pair, const Eigen::Isometry3d& second_from_first,
                                       double min_angle_rad) {
  const Eigen::Vector3d first = second_from_first.rotation() * Ray(pair.first);  // in the second camera's axes
  const Eigen::Vector3d second = Ray(pair.second);
  if (Angle(first, second) < min_angle_rad) {
    return std::nullopt;
  }
  // Distances along both rays at which they are nearest to each other.
  const Eigen::Vector3d t = second_from_first.translation();
  const double cosine = first.dot(second);
  const double determinant = 1.0 - cosine * cosine;
  const double along_first = (cosine * second.dot(t) - first.dot(t)) / determinant;
  const double along_second = (second.dot(t) - cosine * first.dot(t)) / determinant;
  if (along_first <= 0.0 || along_second <= 0.0) {
    return std::nullopt;
  }
  return along_first * Ray(pair.first).z();
}

std::optional<Eigen::Isometry3d> RefinePoseByLandmarks(const std::vector<LandmarkObservation>& landmarks,
                                                       const Eigen::Isometry3d& guess, double noise, double min_share) {
  constexpr int kMaxSteps = 20;
  Eigen::Isometry3d pose = guess;
  PoseEquations here = Linearize(landmarks, pose, noise);
  double damping = 1e-4;
  for (int step = 0; step < kMaxSteps && damping < 1e6; ++step) {
    Eigen::Matrix<double, 6, 6> damped = here.information;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Eigen::Matrix<double, 6, 1> change = -damped.ldlt().solve(here.gradient);
    const Eigen::Isometry3d next = Moved(pose, change);
    const PoseEquations there = Linearize(landmarks, next, noise);
    if (there.cost >= here.cost) {
      damping *= 10.0;
      continue;
    }
    const bool converged = here.cost - there.cost < 1e-6 * here.cost;
    pose = next;
    here = there;
    damping *= 0.1;
    if (converged) {
      break;
    }
  }
  if (here.agreeing < min_share * static_cast<double>(landmarks.size())) {
    return std::nullopt;
  }
  return pose;
}

}  // namespace floorloc
