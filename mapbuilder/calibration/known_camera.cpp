// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/known_camera.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <string>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

std::string SizeText(int width_px, int height_px) { return std::to_string(width_px) + "x" + std::to_string(height_px); }

Eigen::Isometry3d CameraFromBoard(const CameraModel& camera, const Board& board, const NamedView& named) {
  const BoardView& view = named.view;
  std::vector<cv::Point3d> on_board;
  std::vector<cv::Point2d> in_image;  // at focal length 1
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const Eigen::Vector2d point = board.Corner(view.corners[i]);
    const Eigen::Vector2d px = camera.Undistort(view.raw_px[i]);
    if (px.allFinite()) {
      on_board.emplace_back(point.x(), point.y(), 0.0);
      in_image.emplace_back((px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy);
    }
  }
  constexpr std::size_t kMinPoints = 4;
  cv::Vec3d rotation, translation;
  if (on_board.size() < kMinPoints || !cv::solvePnP(on_board, in_image, cv::Matx33d::eye(), cv::noArray(), rotation,
                                                    translation, false, cv::SOLVEPNP_IPPE)) {
    throw InputError(named.name,
                     "the board's corners fit no pose of this camera; check that --camera is this camera's");
  }
  cv::solvePnPRefineLM(on_board, in_image, cv::Matx33d::eye(), cv::noArray(), rotation, translation);
  const Eigen::Vector3d axis(rotation[0], rotation[1], rotation[2]);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (axis.norm() > 0.0) {
    pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
  }
  pose.translation() << translation[0], translation[1], translation[2];
  return pose;
}

ViewFit FitView(const CameraModel& camera, const Board& board, const NamedView& named) {
  ViewFit fit;
  fit.name = named.name;
  fit.camera_from_board = CameraFromBoard(camera, board, named);
  double squares_px2 = 0.0;
  for (std::size_t i = 0; i < named.view.corners.size(); ++i) {
    const Eigen::Vector2d on_board = board.Corner(named.view.corners[i]);
    const Eigen::Vector3d p = fit.camera_from_board * Eigen::Vector3d(on_board.x(), on_board.y(), 0.0);
    const Eigen::Vector2d expected_px =
        camera.Distort({camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy});
    const double error_px = (expected_px - named.view.raw_px[i]).norm();
    squares_px2 += error_px * error_px;
    fit.max_px = std::max(fit.max_px, error_px);
  }
  fit.rms_px = std::sqrt(squares_px2 / static_cast<double>(named.view.corners.size()));
  return fit;
}

}  // namespace

CameraCalibration FitKnownCamera(const CameraCalibrationInput& input, const CameraModel& camera) {
  if (input.width_px != camera.width_px || input.height_px != camera.height_px) {
    throw InputError("the images are " + SizeText(input.width_px, input.height_px) +
                     " but the camera of --camera has " + SizeText(camera.width_px, camera.height_px) +
                     "; take images of the size of its calibration");
  }
  CameraCalibration calibration;
  calibration.camera = camera;
  double squares_px2 = 0.0;
  double corners = 0.0;
  for (const NamedView& view : input.views) {
    calibration.views.push_back(FitView(camera, input.board, view));
    const auto count = static_cast<double>(view.view.corners.size());
    squares_px2 += count * calibration.views.back().rms_px * calibration.views.back().rms_px;
    corners += count;
  }
  calibration.rms_px = corners > 0.0 ? std::sqrt(squares_px2 / corners) : 0.0;
  return calibration;
}

}  // namespace floorloc
