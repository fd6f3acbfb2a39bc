// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/photometric_aligner.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/photometry/cell_comparison.h"
#include "core/photometry/mounting_average.h"

namespace floorloc {
namespace {

constexpr int kMaxIterations = 6;
constexpr double kConvergedPx = 0.25;

// Margin of the mosaic patch around the frame, so that the fit can move.
constexpr double kMarginPx = 8.0;

// First-order expansion of a displacement about a point. displacement: 2xN, of a point of the base frame.
template <int N, typename Displacement>
CellDisplacement<N> Expand(const Eigen::Vector2d& center, const Displacement& displacement) {
  constexpr double kStepM = 1e-3;
  const Eigen::Matrix<double, 2, N> middle = displacement(center);
  CellDisplacement<N> expanded;
  expanded.template topRows<2>() = middle;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Matrix<double, 2, N> slope =
        (displacement(center + kStepM * Eigen::Vector2d::Unit(axis)) - middle) / kStepM;
    expanded.row(2 + axis) = slope.row(0);
    expanded.row(4 + axis) = slope.row(1);
  }
  return expanded;
}

// Turns displacements in the base frame into the map frame.
template <int N>
CellDisplacement<N> Turned(const Eigen::Matrix2d& rotation, const CellDisplacement<N>& in_base) {
  CellDisplacement<N> in_map;
  in_map.template topRows<2>() = rotation * in_base.template topRows<2>();
  for (int axis = 0; axis < 2; ++axis) {
    in_map.row(2 + axis) = rotation(0, 0) * in_base.row(2 + axis) + rotation(0, 1) * in_base.row(4 + axis);
    in_map.row(4 + axis) = rotation(1, 0) * in_base.row(2 + axis) + rotation(1, 1) * in_base.row(4 + axis);
  }
  return in_map;
}

// The mosaic under a frame, as blurred as asked for.
class BlurredMosaic {
 public:
  BlurredMosaic(const MosaicRaster& raster, const FrameSamples& frame, const Pose2& start) : raster_(raster) {
    const Eigen::Vector2d middle = start * frame.center();
    const double reach = frame.radius_m() + kMarginPx * raster.resolution_m();
    rect_ = {middle.x() - reach, middle.x() + reach, middle.y() - reach, middle.y() + reach};
  }
  const RasterPatch& At(int blur_level) {
    std::optional<RasterPatch>& patch = patches_[static_cast<std::size_t>(blur_level)];
    if (!patch) {
      patch = raster_.Cut(rect_, blur_level);
    }
    return *patch;
  }

 private:
  const MosaicRaster& raster_;
  RectM rect_;
  std::array<std::optional<RasterPatch>, MosaicRaster::kMaxBlurLevel + 1> patches_;
};

// One fit of a frame to the mosaic.
class Fit {
 public:
  Fit(const FrameSamples& frame, BlurredMosaic mosaic, const PhotometricOptions& options)
      : frame_(frame), mosaic_(std::move(mosaic)), options_(options) {}

  // The mosaic is blurred as the frame is: where the frame lacks what the mosaic shows, slopes of the mosaic promise
  // more than the frame can tell, so that steps and covariance become too small.
  PhotometricFit Run(const Pose2& start, bool rough) {
    start_ = start;
    if (rough) {
      blur_level_ = options_.max_blur_level;
    } else {
      ChooseBlur();
    }
    Iterate();
    // A frame that was not where it belongs looked blurred.
    while (blur_level_ > 0 && CorrelationAt(blur_level_ - 1) > CorrelationAt(blur_level_)) {
      --blur_level_;
      Iterate();
    }
    Compare(SampleSet::kAll);
    return Conclude();
  }

 private:
  void ChooseBlur() {
    double correlation = CorrelationAt(0);
    while (blur_level_ < options_.max_blur_level) {
      const double next = CorrelationAt(blur_level_ + 1);
      if (!(next > correlation)) {
        return;
      }
      correlation = next;
      ++blur_level_;
    }
  }

  void Iterate() {
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      Compare(SampleSet::kSparse);
      if (gain_ <= 0.0) {
        return;
      }
      const MountingVector step = MountingStep(problem_, unknowns_);
      unknowns_ += step;
      const double moved_m = step.head<2>().norm() + std::abs(step(2)) * frame_.radius_m();
      if (!(moved_m >= kConvergedPx * mosaic_.At(blur_level_).resolution_m)) {
        return;
      }
    }
  }

  CellWarp MakeWarp(const RasterPatch& patch) const {
    return MakeCellWarp(
        frame_, {start_.yaw() + unknowns_(2), start_ * frame_.center() + unknowns_.head<2>(), unknowns_.tail<4>()},
        patch);
  }

  // Of the cells with the mosaic under the present unknowns, by their sparse samples.
  std::vector<CellCorrelation> CorrelateCells(int blur_level) {
    const RasterPatch& patch = mosaic_.At(blur_level);
    const CellWarp warp = MakeWarp(patch);
    std::vector<CellCorrelation> cells;
    for (int c = 0; c < frame_.cells(); ++c) {
      cells.push_back(CorrelateCell(frame_.sparse_cell(c), warp, patch.gray));
    }
    return cells;
  }

  // Of all cells together.
  double CorrelationAt(int blur_level) {
    double covariance = 0.0;
    double variance_f = 0.0;
    double variance_m = 0.0;
    for (const CellCorrelation& cell : CorrelateCells(blur_level)) {
      if (cell.n >= static_cast<float>(options_.min_cell_samples)) {
        covariance += static_cast<double>(cell.Covariance());
        variance_f += static_cast<double>(cell.VarianceOfFrame());
        variance_m += static_cast<double>(cell.VarianceOfMosaic());
      }
    }
    return variance_f > 0.0 && variance_m > 0.0 ? covariance / std::sqrt(variance_f * variance_m) : 0.0;
  }

  // Correlations and normal equations under the present unknowns, residuals frame - gain * mosaic. A cell is weighted
  // by its correlation: changed floor has no weight.
  void Compare(SampleSet set) {
    const RasterPatch& patch = mosaic_.At(blur_level_);
    const CellWarp warp = MakeWarp(patch);
    min_samples_ = FrameSamples::MinSamples(options_.min_cell_samples, set);
    sums_.assign(static_cast<std::size_t>(frame_.cells()), CellSums());
    double covariance = 0.0;
    double variance = 0.0;
    for (int c = 0; c < frame_.cells(); ++c) {
      CellSums& cell = sums_[static_cast<std::size_t>(c)];
      AddCell(frame_.cell(c, set), frame_.cell_center(c).cast<float>(), warp, patch, &cell);
      covariance += Weight(cell) * static_cast<double>(cell.fm);
      variance += Weight(cell) * static_cast<double>(cell.mm);
    }
    gain_ = variance > 0.0 ? covariance / variance : 0.0;
    Assemble();
  }

  double Weight(const CellSums& cell) const {
    return cell.n >= static_cast<float>(min_samples_) ? std::max(0.0, static_cast<double>(cell.Correlation())) : 0.0;
  }

  // Displacement of a cell in the map by the motion and the mounting.
  CellDisplacement<7> MotionOf(int c) const {
    const Eigen::Matrix2d rotation = Pose2(0.0, 0.0, start_.yaw() + unknowns_(2)).rotation();
    return Expand<7>(frame_.cell_center(c), [&](const Eigen::Vector2d& p) {
      const Eigen::Matrix<double, 2, 4> mounting = rotation * MountingJacobian(frame_.camera_center(), p);
      const Eigen::Vector2d arm = rotation * (p - frame_.center()) + mounting * unknowns_.tail<4>();
      Eigen::Matrix<double, 2, 7> motion;
      motion << 1.0, 0.0, -arm.y(), mounting.row(0), 0.0, 1.0, arm.x(), mounting.row(1);
      return motion;
    });
  }

  void Assemble() {
    problem_ = MountingProblem();
    double squares = 0.0;
    double count = 0.0;
    for (int c = 0; c < frame_.cells(); ++c) {
      const CellSums& cell = sums_[static_cast<std::size_t>(c)];
      const double weight = Weight(cell);
      if (weight <= 0.0) {
        continue;
      }
      const CellDisplacement<7> motion = MotionOf(c);
      const MountingVector pull = motion.transpose() * PullOf(cell, weight);
      problem_.information += motion.transpose() * InformationOf(cell, weight) * motion;
      problem_.gradient += pull;
      problem_.scatter += pull * pull.transpose();
      ++problem_.cells;
      squares += weight * (static_cast<double>(cell.ff) - 2.0 * gain_ * static_cast<double>(cell.fm) +
                           gain_ * gain_ * static_cast<double>(cell.mm));
      count += weight * static_cast<double>(cell.n);
    }
    problem_.variance = count > 0.0 ? std::max(squares / count, 1.0) : 1.0;
  }

  CellMatrix InformationOf(const CellSums& cell, double weight) const {
    return weight * gain_ * gain_ * cell.Information();
  }
  CellVector PullOf(const CellSums& cell, double weight) const { return weight * gain_ * cell.Pull(gain_); }

  double CalibrationSigmaPx() const {
    return frame_.calibration_sigma_px() > 0.0 ? frame_.calibration_sigma_px() : options_.calibration_sigma_px;
  }

  // Adds the calibration's modes and the rows' motion to the problem.
  MountingProblem WithCamera(MountingProblem problem) const {
    problem.readout_sigma = frame_.readout_sigma();
    const Eigen::Matrix2d rotation = Pose2(0.0, 0.0, start_.yaw() + unknowns_(2)).rotation();
    for (int c = 0; c < frame_.cells(); ++c) {
      const CellSums& cell = sums_[static_cast<std::size_t>(c)];
      const double weight = Weight(cell);
      if (weight <= 0.0) {
        continue;
      }
      const CellDisplacement<kCalibrationModes> modes = Turned<kCalibrationModes>(rotation, frame_.cell_modes(c));
      const CellMatrix information = InformationOf(cell, weight);
      const CellDisplacement<7> motion = MotionOf(c);
      problem.by_calibration += motion.transpose() * information * modes;
      problem.calibration_information += modes.transpose() * information * modes;
      problem.calibration_gradient += modes.transpose() * PullOf(cell, weight);
      if (!problem.readout_sigma.isZero()) {
        const CellDisplacement<3> rows = Turned<3>(rotation, frame_.cell_rows(c));
        problem.by_readout.topRows<7>() += motion.transpose() * information * rows;
        problem.by_readout.bottomRows<kCalibrationModes>() += modes.transpose() * information * rows;
        problem.readout_information += rows.transpose() * information * rows;
        problem.readout_gradient += rows.transpose() * PullOf(cell, weight);
      }
    }
    return problem;
  }

  PhotometricFit Conclude() {
    PhotometricFit fit;
    for (const CellCorrelation& cell : CorrelateCells(0)) {
      const bool compares = cell.n >= static_cast<float>(options_.min_cell_samples);
      fit.cell_correlation.push_back(compares ? cell.Correlation() : 0.0F);
      fit.cell_samples.push_back(compares ? static_cast<int>(cell.n) : 0);
    }
    const Eigen::Vector2d bent = MountingJacobian(frame_.camera_center(), frame_.center()) * unknowns_.tail<4>();
    fit.moved_m = (unknowns_.head<2>() + Pose2(0.0, 0.0, start_.yaw() + unknowns_(2)) * bent).norm();
    const MountingProblem problem = WithCamera(problem_);
    const MountingEstimate estimate = frame_.camera_prior()
                                          ? MarginalizeMounting(problem, unknowns_, *frame_.camera_prior())
                                          : MarginalizeMounting(problem, unknowns_, CalibrationSigmaPx());
    fit.camera = EvidenceOfCamera(problem, unknowns_, estimate.vibration, options_.mosaic_sigma_px);
    fit.camera.view_radius_m = frame_.radius_m();
    fit.camera.camera = frame_.camera_key();
    // From the motion about the frame's centre to the pose of the base.
    const double yaw = start_.yaw() + estimate.mean(2);
    const Eigen::Vector2d arm = Pose2(0.0, 0.0, yaw) * frame_.center();
    const Eigen::Vector2d t = start_ * frame_.center() + estimate.mean.head<2>() - arm;
    fit.map_from_base = Pose2(t.x(), t.y(), yaw);
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    jacobian(0, 2) = arm.y();
    jacobian(1, 2) = -arm.x();
    fit.covariance = jacobian * estimate.covariance.topLeftCorner<3, 3>() * jacobian.transpose();
    fit.mounting = {estimate.mean.segment<3>(3), estimate.mean(6)};
    return fit;
  }

  const FrameSamples& frame_;
  BlurredMosaic mosaic_;
  const PhotometricOptions& options_;
  Pose2 start_;
  int blur_level_ = 0;
  int min_samples_ = 0;  // of a cell that is compared
  MountingVector unknowns_ = MountingVector::Zero();
  std::vector<CellSums> sums_;
  double gain_ = 0.0;
  MountingProblem problem_;
};

// Mean of the first `share` of the values.
double MeanOf(const std::vector<float>& values, double share) {
  const auto count = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size())));
  return count > 0 ? std::accumulate(values.begin(), values.begin() + count, 0.0) / static_cast<double>(count) : 0.0;
}

}  // namespace

void PhotometricOptions::Check() const {
  RequireOption(min_cell_samples >= 1, "min_cell_samples must be positive");
  RequireOption(min_correlation >= 0 && min_correlation < 1, "min_correlation must be 0 to 1");
  RequireOption(max_correction_radii > 0, "max_correction_radii must be positive");
  RequireOption(max_blur_level >= 0 && max_blur_level <= MosaicRaster::kMaxBlurLevel, "max_blur_level must be 0 to 3");
  RequireOption(sure_inliers >= 0, "sure_inliers must not be negative");
  RequireOption(mosaic_sigma_px > 0, "mosaic_sigma_px must be positive");
  RequireOption(readout_motion_share >= 0.0 && readout_motion_share <= 1.0, "readout_motion_share must be 0 to 1");
  RequireOption(readout_turn_sigma_rad_per_m >= 0.0, "readout_turn_sigma_rad_per_m must not be negative");
  RequireOption(calibration_sigma_px >= 0, "calibration_sigma_px must not be negative");
}

std::vector<float> PhotometricFit::ComparedCells() const {
  std::vector<float> cells;
  for (std::size_t c = 0; c < cell_correlation.size(); ++c) {
    if (cell_samples[c] > 0) {
      cells.push_back(cell_correlation[c]);
    }
  }
  return cells;
}

double PhotometricFit::MeanCorrelation() const { return MeanOf(ComparedCells(), 1.0); }

double PhotometricFit::TrimmedCorrelation(double share) const {
  std::vector<float> cells = ComparedCells();
  std::sort(cells.begin(), cells.end());
  return MeanOf(cells, share);
}

FrameSamples::FrameSamples(const GroundImage& image, const cv::Mat& normalized, const Rectifier& rectifier)
    : camera_center_(rectifier.camera().CameraCenter()),
      calibration_sigma_px_(rectifier.camera().camera.sigma_px),
      camera_key_(CameraKey(rectifier.camera())),
      grid_(image.grid) {
  const GroundGrid& grid = image.grid;
  center_ = grid.BaseFromPixel(0.5 * (grid.width_px - 1), 0.5 * (grid.height_px - 1));
  radius_m_ = 0.5 * grid.resolution_m * std::hypot(grid.width_px, grid.height_px);
  for (int top = 0; top < grid.height_px; top += kCellPx) {
    for (int left = 0; left < grid.width_px; left += kCellPx) {
      AddCell({image, normalized}, cv::Rect(left, top, kCellPx, kCellPx) & cv::Rect({}, normalized.size()));
    }
  }
  for (int c = 0; c < cells(); ++c) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Sample& sample : cell(c)) {
      sum += Eigen::Vector2d(sample.x_m, sample.y_m);
    }
    const bool empty = cell(c).empty();
    cell_centers_.push_back(empty ? center_ : Eigen::Vector2d(sum / static_cast<double>(cell(c).size())));
    cell_modes_.push_back(empty ? CellDisplacement<kCalibrationModes>::Zero()
                                : Expand<kCalibrationModes>(cell_centers_.back(), [&](const Eigen::Vector2d& p) {
                                    return rectifier.calibration_modes().At(p);
                                  }));
  }
}

void FrameSamples::SetReadout(const FloorCamera& camera, const Eigen::Vector3d& sigma) {
  readout_sigma_ = sigma;
  cell_rows_.clear();
  for (const Eigen::Vector2d& center : cell_centers_) {
    cell_rows_.push_back(Expand<3>(center, [&](const Eigen::Vector2d& p) -> Eigen::Matrix<double, 2, 3> {
      const Eigen::Vector2d arm = p - center_;
      Eigen::Matrix<double, 2, 3> moved;
      moved << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
      return ReadoutShare(camera.camera, camera.RawPixelFromFloor(p)) * moved;
    }));
  }
}

void FrameSamples::AddCell(const NormalizedImage& image, const cv::Rect& cell) {
  constexpr int kSparse = 2;  // every other sample of a row and of a column
  const auto add = [&](bool sparse) {
    for (int v = 0; v * kStridePx < cell.height; ++v) {
      for (int u = 0; u * kStridePx < cell.width; ++u) {
        const cv::Point pixel(cell.x + u * kStridePx, cell.y + v * kStridePx);
        if ((u % kSparse == 1 && v % kSparse == 1) == sparse && image.floor.mask.at<std::uint8_t>(pixel) != 0) {
          const Eigen::Vector2f p = image.floor.grid.BaseFromPixel(pixel.x, pixel.y).cast<float>();
          samples_.push_back({p.x(), p.y(), static_cast<float>(image.gray.at<std::uint8_t>(pixel)) - kMiddle});
        }
      }
    }
  };
  add(true);
  sparse_end_.push_back(static_cast<int>(samples_.size()));
  add(false);
  cell_start_.push_back(static_cast<int>(samples_.size()));
}

int FrameSamples::CellAt(const Eigen::Vector2d& point_in_base) const {
  const Eigen::Vector2d pixel = grid_.PixelFromBase(point_in_base);
  const auto u = static_cast<int>(std::lround(pixel.x()));
  const auto v = static_cast<int>(std::lround(pixel.y()));
  if (u < 0 || v < 0 || u >= grid_.width_px || v >= grid_.height_px) {
    return -1;
  }
  const int columns = (grid_.width_px + kCellPx - 1) / kCellPx;
  return v / kCellPx * columns + u / kCellPx;
}

PhotometricFit PhotometricAligner::Align(const FrameSamples& frame, const Pose2& start, bool rough) const {
  return Fit(frame, BlurredMosaic(raster_, frame, start), options_).Run(start, rough);
}

}  // namespace floorloc
