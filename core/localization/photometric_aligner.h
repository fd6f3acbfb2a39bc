// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/mounting.h"
#include "core/geometry/pose2.h"
#include "core/map/mosaic_raster.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// When a fit to the mosaic is believed. All from 13d8f43; `./run bench honesty` for right or wrong, `./run bench` for
/// how far off.
struct PhotometricOptions {
  int min_cell_samples = 16;  ///< pixels on surveyed floor below which a cell of the frame compares nothing
  /// A frame whose cells correlate less with the mosaic, in the mean, keeps the pose that its keypoints gave it.
  double min_correlation = 0.15;
  /// How far the mosaic may correct where the keypoints put the middle of the frame, in inlier radii: a fit can slide
  /// off.
  double max_correction_radii = 2.0;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// A frame aligned to the mosaic.
struct PhotometricFit {
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< x, y, yaw; additive, map frame; m^2, m rad, rad^2
  MountingError mounting;                                ///< deviation of the camera from its calibration
  double moved_m = 0.0;                                  ///< how far the middle of the image moved over the mosaic
  std::vector<float> cell_correlation;                   ///< per cell of the frame, -1..1; 0 where nothing compares
  std::vector<int> cell_samples;                         ///< pixels compared per cell

  /// Over the cells that compare; 0 when there are none.
  double MeanCorrelation() const;
  /// Over the lower `share` of them: a few lines that cross the whole floor do not raise it.
  double TrimmedCorrelation(double share) const;
};

/// The pixels of a frame that are compared, its image contrast-normalised as the mosaic's. The image is divided into
/// square cells, so that changed floor spoils its cells only.
class FrameSamples {
 public:
  /// normalized: CV_8UC1 of the image's grid, 128 in the mean.
  FrameSamples(const GroundImage& image, const cv::Mat& normalized);

  struct Sample {
    float x_m, y_m;  // base frame
    float value;     // normalised grey level, 0 in the mean
  };
  int cells() const { return static_cast<int>(cell_start_.size()) - 1; }
  std::span<const Sample> cell(int c) const {
    const auto i = static_cast<std::size_t>(c);
    return {samples_.data() + cell_start_[i], samples_.data() + cell_start_[i + 1]};
  }
  /// Cell of a point of the base frame; -1 outside the image.
  int CellAt(const Eigen::Vector2d& point_in_base) const;
  /// Middle of what the camera sees, base frame.
  const Eigen::Vector2d& center() const { return center_; }
  double radius_m() const { return radius_m_; }

 private:
  std::vector<Sample> samples_;  // cell by cell
  std::vector<int> cell_start_{0};
  GroundGrid grid_;
  Eigen::Vector2d center_ = Eigen::Vector2d::Zero();
  double radius_m_ = 0.0;  // of the circle about the centre that holds all samples
};

/// Aligns frames to the mosaic by their grey levels (Lucas & Kanade 1981, forward additive), with the camera's mounting
/// among the unknowns: its deviation is separable from a motion by the perspective distortion of the image.
class PhotometricAligner {
 public:
  /// Refers to the raster, which must outlive it.
  explicit PhotometricAligner(const MosaicRaster& raster, const PhotometricOptions& options = {})
      : raster_(raster), options_(options) {}

  /// start: map_from_base, a few pixels from the truth at most. camera_center: base frame.
  PhotometricFit Align(const FrameSamples& frame, const Eigen::Vector3d& camera_center, const Pose2& start) const;

 private:
  const MosaicRaster& raster_;
  PhotometricOptions options_;
};

}  // namespace floorloc
