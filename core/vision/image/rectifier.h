// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/geometry/calibration_modes.h"
#include "core/geometry/floor_plane.h"
#include "core/vision/image/ground_image.h"
#include "core/vision/image/readout_warp.h"

namespace floorloc {

/// Raw camera image -> GroundImage: undistortion and homography in one precomputed fixed-point map, restricted to
/// the region of interest and to what is not masked. Immutable after construction; Rectify may run in many threads.
class Rectifier {
 public:
  /// raw_mask: CV_8UC1 of the camera's size, 0 where its images show no floor (the robot's body); may be empty. Throws
  /// std::invalid_argument when the camera does not pass FloorCamera::Check(), or the mask is none of this camera.
  explicit Rectifier(const FloorCamera& camera, const cv::Mat& raw_mask = cv::Mat());

  /// raw: CV_8UC1 of the camera's size; throws std::invalid_argument otherwise.
  GroundImage Rectify(const cv::Mat& raw) const;
  /// Of a camera that moves while its image is read out (ReadoutMotion::motion): every row is put where it belongs when
  /// the middle one is exposed.
  GroundImage Rectify(const cv::Mat& raw, const Eigen::Vector3d& motion) const;
  /// A part of it: the same pixels. part: pixels of the rectified image, within it.
  GroundImage Rectify(const cv::Mat& raw, const cv::Rect& part,
                      const Eigen::Vector3d& motion = Eigen::Vector3d::Zero()) const;
  /// The same for mosaics, grey or colour: CV_8UC1 or CV_8UC3, returns the same type; invalid pixels are 0.
  cv::Mat RectifyImage(const cv::Mat& raw) const;

  const FloorCamera& camera() const { return camera_; }
  /// How errors of the camera's calibration displace the floor.
  const CalibrationModes& calibration_modes() const { return calibration_modes_; }
  const GroundGrid& grid() const { return grid_; }
  /// CV_8UC1 of the rectified image, 255 where it shows floor.
  const cv::Mat& mask() const { return mask_; }
  /// As given, with 255 for all that is not 0; empty: none was given.
  const cv::Mat& raw_mask() const { return raw_mask_; }
  /// Share of the floor in view that the mask takes away, 0 to 1.
  double masked_share() const { return masked_share_; }

 private:
  void ApplyMask();
  cv::Mat Remap(const cv::Mat& raw, const PixelMap& map) const;

  FloorCamera camera_;
  CalibrationModes calibration_modes_;
  GroundGrid grid_;
  PixelMap map_;
  cv::Mat mask_;
  cv::Mat raw_mask_;
  double masked_share_ = 0.0;
};

}  // namespace floorloc
