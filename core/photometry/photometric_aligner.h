// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/calibration_modes.h"
#include "core/geometry/floor_plane.h"
#include "core/geometry/mounting.h"
#include "core/geometry/pose2.h"
#include "core/map/mosaic_raster.h"
#include "core/photometry/camera_errors.h"
#include "core/vision/image/ground_image.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {

/// When a fit to the mosaic is accepted. All chosen in 13d8f43; `./run bench honesty` measures wrong fixes, `./run
/// bench` accuracy.
struct PhotometricOptions {
  int min_cell_samples = 16;  ///< cells of the frame with fewer pixels on surveyed floor are not compared
  /// With a smaller mean correlation of its cells a frame keeps the pose by keypoints.
  double min_correlation = 0.15;
  /// Largest correction of the frame's centre relative to the pose by keypoints, in inlier radii: a fit can diverge.
  double max_correction_radii = 2.0;
  /// The mosaic is blurred up to this level (MosaicRaster::Cut) where a frame agrees better with it then: one that is
  /// blurred, or taken from higher than the map's. 0: never. Effect: docs/benchmarks/views.md.
  int max_blur_level = 3;
  /// A pose by fewer inliers is a rough start: in frames with 20 to 30 pixels of motion blur few keypoints match, by
  /// chance at one end of the blur, and the nearest optimum is up to 6 mm off (docs/benchmarks/blur.md).
  int sure_inliers = 120;
  /// Standard deviation of the calibration of a camera that does not tell its own (CameraModel::sigma_px), pixels at
  /// the corners of the region of interest: a careful one leaves 0.2 to 1 px. `./run bench calibration` measures its
  /// effect.
  double calibration_sigma_px = 0.3;
  /// Standard deviation of the mosaic's errors within a view, pixels at its corners: a place tells no more of a camera
  /// than this. Neighbouring frames of good maps agree to 0.05 mm, and systematic errors are thrice as large
  /// (LocalizerOptions::systematic_m): 0.2 px of 0.7 mm.
  double mosaic_sigma_px = 0.2;
  /// Standard deviation of the motion by which the rows of a rolling shutter were put where they belong, as a share of
  /// it: wheels tell it with noise and late, at 1 m/s with 50 increments per second 1 to 4 % off in curves. The image
  /// itself then tells how its rows moved, and this is what is known before. 0: the motion is exact.
  double readout_motion_share = 0.03;
  /// The same of the turn, beside its share, radians per metre of that motion: wheels whose heading strays by 5 mrad
  /// after one metre (OdometryNoise) tell the turn during 0.04 s at 1 m/s with 0.025 rad/s, its change with as much.
  double readout_turn_sigma_rad_per_m = 0.05;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// A frame aligned to the mosaic.
struct PhotometricFit {
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< x, y, yaw; additive, map frame; m^2, m rad, rad^2
  MountingError mounting;                                ///< deviation of the camera from its calibration
  CameraEvidence camera;                                 ///< what the frame tells of its camera's constant errors
  double moved_m = 0.0;                                  ///< displacement of the image's centre by the fit
  /// Per cell of the frame, with the mosaic as sharp as it is, -1..1; 0: not compared.
  std::vector<float> cell_correlation;
  std::vector<int> cell_samples;  ///< pixels compared per cell

  /// Correlations of the compared cells.
  std::vector<float> ComparedCells() const;
  /// Mean over the compared cells; 0 when there are none.
  double MeanCorrelation() const;
  /// Mean over the lowest `share` of the compared cells: a few lines that cross the whole floor do not raise it.
  double TrimmedCorrelation(double share) const;
};

/// Displacement of a cell's pixels per unit of N unknowns, to first order about the cell's centre: at the centre (x,
/// y), then its derivative by the position, row by row (xx, xy, yx, yy).
template <int N>
using CellDisplacement = Eigen::Matrix<double, 6, N>;

/// Which samples of a cell are compared: one of FrameSamples::kSparseShare, enough to get near, or all.
enum class SampleSet { kSparse, kAll };

/// The pixels of a frame that are compared, its image contrast-normalised as the mosaic's. The image is divided into
/// square cells, so that changed floor affects only its own cells.
class FrameSamples {
 public:
  static constexpr int kCellPx = 48;        ///< side of a cell
  static constexpr int kSparseShare = 4;    ///< one of so many samples is a sparse one
  static constexpr float kMiddle = 128.0F;  ///< mean grey level of a normalised image

  /// normalized: CV_8UC1 of the image's grid, mean 128. rectifier: of the image.
  FrameSamples(const GroundImage& image, const cv::Mat& normalized, const Rectifier& rectifier);

  struct Sample {
    float x_m, y_m;  // base frame
    float value;     // normalised grey level, mean 0
  };
  int cells() const { return static_cast<int>(cell_start_.size()) - 1; }
  std::span<const Sample> cell(int c) const {
    const auto i = static_cast<std::size_t>(c);
    return {samples_.data() + cell_start_[i], samples_.data() + cell_start_[i + 1]};
  }
  /// The first of them, spread over the cell: enough to get near.
  std::span<const Sample> sparse_cell(int c) const {
    const auto i = static_cast<std::size_t>(c);
    return {samples_.data() + cell_start_[i], samples_.data() + sparse_end_[i]};
  }
  std::span<const Sample> cell(int c, SampleSet set) const { return set == SampleSet::kAll ? cell(c) : sparse_cell(c); }
  /// How many samples a cell must have in common with the mosaic; min_sparse: of the sparse ones.
  static constexpr int MinSamples(int min_sparse, SampleSet set) {
    return min_sparse * (set == SampleSet::kAll ? kSparseShare : 1);
  }
  /// Mean position of a cell's samples, base frame, metres.
  const Eigen::Vector2d& cell_center(int c) const { return cell_centers_[static_cast<std::size_t>(c)]; }
  /// How errors of the calibration displace a cell.
  const CellDisplacement<kCalibrationModes>& cell_modes(int c) const {
    return cell_modes_[static_cast<std::size_t>(c)];
  }
  /// Of an image whose rows were put where they belong. sigma: positive standard deviations of the motion of the view's
  /// centre during the read-out (x, y, yaw: base frame, m and rad) by which that was done.
  void SetReadout(const FloorCamera& camera, const Eigen::Vector3d& sigma);
  /// Zero: no row was moved, or exactly.
  const Eigen::Vector3d& readout_sigma() const { return readout_sigma_; }
  /// How an error of that motion displaces a cell; only where readout_sigma is not zero.
  const CellDisplacement<3>& cell_rows(int c) const { return cell_rows_[static_cast<std::size_t>(c)]; }
  /// CameraModel::sigma_px of the camera; 0: unknown.
  double calibration_sigma_px() const { return calibration_sigma_px_; }
  /// What is known of the camera's errors; empty, or of another calibration: nothing but calibration_sigma_px.
  void SetCameraPrior(const std::optional<CameraPrior>& prior) {
    camera_prior_ = prior && prior->camera == camera_key_ ? prior : std::nullopt;
  }
  const std::optional<CameraPrior>& camera_prior() const { return camera_prior_; }
  std::size_t camera_key() const { return camera_key_; }
  /// Position of the camera in the base frame, metres.
  const Eigen::Vector3d& camera_center() const { return camera_center_; }
  /// Cell of a point of the base frame; -1 outside the image.
  int CellAt(const Eigen::Vector2d& point_in_base) const;
  /// Centre of the visible floor, base frame, metres.
  const Eigen::Vector2d& center() const { return center_; }
  double radius_m() const { return radius_m_; }
  /// Metres per pixel of the image.
  double resolution_m() const { return grid_.resolution_m; }

 private:
  // Denser ones hardly tell more: error of hard frames 0.35, 0.24, 0.21, 0.19 mm at 6, 4, 3, 2 pixels.
  static constexpr int kStridePx = 3;

  struct NormalizedImage {
    const GroundImage& floor;
    const cv::Mat& gray;
  };

  void AddCell(const NormalizedImage& image, const cv::Rect& cell);

  std::vector<Sample> samples_;  // cell by cell
  std::vector<int> cell_start_{0};
  std::vector<int> sparse_end_;
  std::vector<Eigen::Vector2d> cell_centers_;
  std::vector<CellDisplacement<kCalibrationModes>> cell_modes_;
  std::vector<CellDisplacement<3>> cell_rows_;
  Eigen::Vector3d readout_sigma_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d camera_center_ = Eigen::Vector3d::Zero();
  double calibration_sigma_px_ = 0.0;
  std::size_t camera_key_ = 0;
  std::optional<CameraPrior> camera_prior_;
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

  /// start: map_from_base, a few pixels from the truth at most. rough: it may be farther off; then frame and mosaic are
  /// first compared as blurred as they can be.
  PhotometricFit Align(const FrameSamples& frame, const Pose2& start, bool rough = false) const;

 private:
  const MosaicRaster& raster_;
  PhotometricOptions options_;
};

}  // namespace floorloc
