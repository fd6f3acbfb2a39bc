// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/geometry/mounting.h"
#include "core/map/mosaic_raster.h"
#include "core/photometry/photometric_aligner.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {

/// An exact mosaic of a synthetic floor, in PNG tiles.
class PerfectMosaic {
 public:
  PerfectMosaic(const FloorTexture& floor, double resolution_m) : layout_{256, 0, resolution_m} {
    const double scale = resolution_m / floor.resolution_m;
    cv::Mat smooth;
    cv::cvtColor(floor.bgr, smooth, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(smooth, smooth, {}, 0.4 * scale);
    for (int y = 0; y * layout_.TileSide(0) < floor.height_m(); ++y) {
      for (int x = 0; x * layout_.TileSide(0) < floor.width_m(); ++x) {
        const Eigen::Vector2d upper_left((x * 256 + 0.5) * resolution_m, ((y + 1) * 256 - 0.5) * resolution_m);
        const Eigen::Vector2d texel = floor.PixelFromMap(upper_left);
        const cv::Matx23d texture_from_tile(scale, 0.0, texel.x(), 0.0, scale, texel.y());
        cv::Mat tile;
        cv::warpAffine(smooth, tile, texture_from_tile, {256, 256}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
        cv::imencode(".png", tile, encoded_[{0, x, y}]);
      }
    }
  }

  MosaicTileSource Source() const {
    return [this](const TileId& id) -> std::optional<std::vector<std::uint8_t>> {
      const auto it = encoded_.find(id);
      return it == encoded_.end() ? std::nullopt : std::optional(it->second);
    };
  }
  const MosaicLayout& layout() const { return layout_; }

 private:
  MosaicLayout layout_;
  std::map<TileId, std::vector<std::uint8_t>> encoded_;
};

/// The mounting error equivalent to a renderer's vibration, to first order.
inline MountingError ToMountingError(const CameraVibration& vibration, const FloorCamera& camera) {
  return {{vibration.roll_rad, vibration.pitch_rad, 0.0}, vibration.height_m / camera.CameraCenter().z()};
}

/// The best rigid fit to a vibrated image without mounting unknowns, as keypoints give it.
inline Pose2 RigidFit(const FloorCamera& camera, const Pose2& truth, const MountingError& error) {
  constexpr int kSteps = 10;
  const RectM& roi = camera.floor.roi;
  Eigen::Vector4d unknown;
  unknown << error.rotation_rad, error.height_share;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d p(roi.x_min + roi.width_m() * i / kSteps, roi.y_min + roi.height_m() * j / kSteps);
      Eigen::Matrix<double, 2, 3> moves;
      moves << 1.0, 0.0, -p.y(), 0.0, 1.0, p.x();
      information += moves.transpose() * moves;
      pull += moves.transpose() * (MountingJacobian(camera.CameraCenter(), p) * unknown);
    }
  }
  const Eigen::Vector3d twist = information.ldlt().solve(pull);
  return truth * Pose2(twist.x(), twist.y(), twist.z());
}

/// Largest error of the floor under the region of interest, metres.
inline double ViewError(const FloorCamera& camera, const Pose2& estimate, const Pose2& truth) {
  const RectM& roi = camera.floor.roi;
  double worst = 0.0;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      const Eigen::Vector2d corner(x, y);
      worst = std::max(worst, (estimate * corner - truth * corner).norm());
    }
  }
  return worst;
}

}  // namespace floorloc
