// SPDX-License-Identifier: Apache-2.0
#include "core/localization/photometric_aligner.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/geometry/option_check.h"
#include "core/localization/mounting_average.h"

namespace floorloc {
namespace {

// Mean grey level of a normalised image.
constexpr float kMiddle = 128.0F;

constexpr int kSampleStridePx = 6;
constexpr int kCellPx = 48;
constexpr int kMaxIterations = 6;
constexpr double kConvergedPx = 0.25;

// Margin of the mosaic patch around the frame, so that the fit can move.
constexpr double kMarginPx = 8.0;

// What a pixel tells of a displacement that is linear in the cell: its slope (gx, gy), and the slope times the position
// relative to the cell's centre (gx dx, gx dy, gy dx, gy dy). Eight floats, so that compilers keep a row in one
// register; the last two are padding.
constexpr int kRow = 8;
using Row = std::array<float, kRow>;

// Sums over the pixels of a cell.
struct CellSums {
  float n = 0.0F, f = 0.0F, m = 0.0F, ff = 0.0F, mm = 0.0F, fm = 0.0F;
  std::array<Row, kRow> information{};  // of row row^T
  Row frame_pull{};                     // of row * frame
  Row mosaic_pull{};                    // of row * mosaic

  void Add(float frame, float mosaic, const Row& row) {
    n += 1.0F;
    f += frame;
    m += mosaic;
    ff += frame * frame;
    mm += mosaic * mosaic;
    fm += frame * mosaic;
    for (std::size_t i = 0; i < kRow; ++i) {
      for (std::size_t j = 0; j < kRow; ++j) {
        information[i][j] += row[i] * row[j];
      }
      frame_pull[i] += row[i] * frame;
      mosaic_pull[i] += row[i] * mosaic;
    }
  }
  float Correlation() const {
    const float variance_f = ff - f * f / n;
    const float variance_m = mm - m * m / n;
    return variance_f > 0.0F && variance_m > 0.0F ? (fm - f * m / n) / std::sqrt(variance_f * variance_m) : 0.0F;
  }
};

// The estimated motion, as numbers for the inner loop: a pixel of the frame -> a pixel of the mosaic.
struct Warp {
  float cos_yaw, sin_yaw;
  float camera_x, camera_y, height;  // base frame
  float center_x, center_y;          // base frame, about which the frame turns
  float middle_u, middle_v;          // mosaic pixel of the centre
  float per_m;                       // px per metre
  float rotation_x, rotation_y, rotation_z, height_share;

  struct Point {
    float u, v;
  };

  Point At(const FrameSamples::Sample& s) const {
    const float x = s.x_m - camera_x;
    const float y = s.y_m - camera_y;
    const float inverse = 1.0F / height;
    // Columns of MountingJacobian().
    const float ax = x * y * inverse, ay = height + y * y * inverse;
    const float bx = -(height + x * x * inverse), by = -x * y * inverse;
    const float px = s.x_m - center_x + ax * rotation_x + bx * rotation_y - y * rotation_z + x * height_share;
    const float py = s.y_m - center_y + ay * rotation_x + by * rotation_y + x * rotation_z + y * height_share;
    return {middle_u + (cos_yaw * px - sin_yaw * py) * per_m, middle_v - (sin_yaw * px + cos_yaw * py) * per_m};
  }
};

// Adds the pixels of a cell that lie on surveyed floor. Slopes are grey levels per metre in the map.
void AddCell(std::span<const FrameSamples::Sample> samples, const Eigen::Vector2f& center, const Warp& warp,
             const cv::Mat& gray, CellSums* sums) {
  for (const FrameSamples::Sample& s : samples) {
    const Warp::Point p = warp.At(s);
    if (!(p.u >= 0.0F && p.v >= 0.0F && p.u < static_cast<float>(gray.cols - 1) &&
          p.v < static_cast<float>(gray.rows - 1))) {
      continue;
    }
    const int column = static_cast<int>(p.u);
    const int row = static_cast<int>(p.v);
    const std::uint8_t* upper = gray.ptr<std::uint8_t>(row) + column;
    const std::uint8_t* lower = upper + gray.step[0];
    if (upper[0] == 0 || upper[1] == 0 || lower[0] == 0 || lower[1] == 0) {
      continue;
    }
    const float a = p.u - static_cast<float>(column);
    const float b = p.v - static_cast<float>(row);
    const auto upper_slope = static_cast<float>(upper[1] - upper[0]);
    const auto lower_slope = static_cast<float>(lower[1] - lower[0]);
    const float top = static_cast<float>(upper[0]) + a * upper_slope;
    const float bottom = static_cast<float>(lower[0]) + a * lower_slope;
    // Image rows run against the y axis.
    const float gx = (upper_slope + b * (lower_slope - upper_slope)) * warp.per_m;
    const float gy = (top - bottom) * warp.per_m;
    const float dx = s.x_m - center.x();
    const float dy = s.y_m - center.y();
    sums->Add(s.value, top + b * (bottom - top) - kMiddle, {gx, gy, gx * dx, gx * dy, gy * dx, gy * dy, 0.0F, 0.0F});
  }
}

using CellVector = Eigen::Matrix<double, 6, 1>;
using CellMatrix = Eigen::Matrix<double, 6, 6>;

CellVector ToVector(const Row& row) {
  CellVector v;
  for (int i = 0; i < v.size(); ++i) {
    v(i) = static_cast<double>(row[static_cast<std::size_t>(i)]);
  }
  return v;
}

CellMatrix ToMatrix(const std::array<Row, kRow>& rows) {
  CellMatrix m;
  for (int i = 0; i < m.rows(); ++i) {
    m.row(i) = ToVector(rows[static_cast<std::size_t>(i)]).transpose();
  }
  return m;
}

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

// One fit of a frame to a patch of the mosaic.
class Fit {
 public:
  Fit(const FrameSamples& frame, const RasterPatch& patch, const PhotometricOptions& options)
      : frame_(frame), patch_(patch), options_(options) {}

  PhotometricFit Run(const Pose2& start) {
    start_ = start;
    Compare();
    for (int iteration = 0; iteration < kMaxIterations && gain_ > 0.0; ++iteration) {
      const MountingVector step = MountingStep(problem_, unknowns_);
      unknowns_ += step;
      Compare();
      const double moved_m = step.head<2>().norm() + std::abs(step(2)) * frame_.radius_m();
      if (!(moved_m >= kConvergedPx * patch_.resolution_m)) {
        break;
      }
    }
    return Conclude();
  }

 private:
  Warp MakeWarp() const {
    const double yaw = start_.yaw() + unknowns_(2);
    const Eigen::Vector2d middle = patch_.PixelFromMap(start_ * frame_.center() + unknowns_.head<2>());
    const Eigen::Matrix<float, 14, 1> n =
        (Eigen::Matrix<double, 14, 1>() << std::cos(yaw), std::sin(yaw), frame_.camera_center(), frame_.center(),
         middle, 1.0 / patch_.resolution_m, unknowns_.tail<4>())
            .finished()
            .cast<float>();
    return {n(0), n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), n(11), n(12), n(13)};
  }

  // Correlations and normal equations under the present unknowns, residuals frame - gain * mosaic. A cell is weighted
  // by its correlation: changed floor has no weight.
  void Compare() {
    const Warp warp = MakeWarp();
    sums_.assign(static_cast<std::size_t>(frame_.cells()), CellSums());
    double covariance = 0.0;
    double variance = 0.0;
    for (int c = 0; c < frame_.cells(); ++c) {
      CellSums& cell = sums_[static_cast<std::size_t>(c)];
      AddCell(frame_.cell(c), frame_.cell_center(c).cast<float>(), warp, patch_.gray, &cell);
      covariance += Weight(cell) * static_cast<double>(cell.fm);
      variance += Weight(cell) * static_cast<double>(cell.mm);
    }
    gain_ = variance > 0.0 ? covariance / variance : 0.0;
    Assemble();
  }

  bool Compares(const CellSums& cell) const { return cell.n >= static_cast<float>(options_.min_cell_samples); }
  double Weight(const CellSums& cell) const {
    return Compares(cell) ? std::max(0.0, static_cast<double>(cell.Correlation())) : 0.0;
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
    return weight * gain_ * gain_ * ToMatrix(cell.information);
  }
  CellVector PullOf(const CellSums& cell, double weight) const {
    return weight * gain_ * (ToVector(cell.frame_pull) - gain_ * ToVector(cell.mosaic_pull));
  }

  double CalibrationSigmaPx() const {
    return frame_.calibration_sigma_px() > 0.0 ? frame_.calibration_sigma_px() : options_.calibration_sigma_px;
  }

  // Adds the calibration's modes to the problem.
  MountingProblem WithCalibration(MountingProblem problem) const {
    const Eigen::Matrix2d rotation = Pose2(0.0, 0.0, start_.yaw() + unknowns_(2)).rotation();
    for (int c = 0; c < frame_.cells(); ++c) {
      const CellSums& cell = sums_[static_cast<std::size_t>(c)];
      const double weight = Weight(cell);
      if (weight <= 0.0) {
        continue;
      }
      const CellDisplacement<kCalibrationModes> modes = Turned<kCalibrationModes>(rotation, frame_.cell_modes(c));
      const CellMatrix information = InformationOf(cell, weight);
      problem.by_calibration += MotionOf(c).transpose() * information * modes;
      problem.calibration_information += modes.transpose() * information * modes;
      problem.calibration_gradient += modes.transpose() * PullOf(cell, weight);
    }
    return problem;
  }

  PhotometricFit Conclude() const {
    PhotometricFit fit;
    for (const CellSums& cell : sums_) {
      fit.cell_correlation.push_back(Compares(cell) ? cell.Correlation() : 0.0F);
      fit.cell_samples.push_back(Compares(cell) ? static_cast<int>(cell.n) : 0);
    }
    const Eigen::Vector2d bent = MountingJacobian(frame_.camera_center(), frame_.center()) * unknowns_.tail<4>();
    fit.moved_m = (unknowns_.head<2>() + Pose2(0.0, 0.0, start_.yaw() + unknowns_(2)) * bent).norm();
    const MountingProblem problem = WithCalibration(problem_);
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
  const RasterPatch& patch_;
  const PhotometricOptions& options_;
  Pose2 start_;
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
  RequireOption(mosaic_sigma_px > 0, "mosaic_sigma_px must be positive");
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
      for (int v = top + kSampleStridePx / 2; v < std::min(top + kCellPx, grid.height_px); v += kSampleStridePx) {
        for (int u = left + kSampleStridePx / 2; u < std::min(left + kCellPx, grid.width_px); u += kSampleStridePx) {
          if (image.mask.at<std::uint8_t>(v, u) != 0) {
            const Eigen::Vector2f p = grid.BaseFromPixel(u, v).cast<float>();
            samples_.push_back({p.x(), p.y(), static_cast<float>(normalized.at<std::uint8_t>(v, u)) - kMiddle});
          }
        }
      }
      cell_start_.push_back(static_cast<int>(samples_.size()));
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

PhotometricFit PhotometricAligner::Align(const FrameSamples& frame, const Pose2& start) const {
  const Eigen::Vector2d middle = start * frame.center();
  const double reach = frame.radius_m() + kMarginPx * raster_.resolution_m();
  const RasterPatch patch =
      raster_.Cut({middle.x() - reach, middle.x() + reach, middle.y() - reach, middle.y() + reach});
  return Fit(frame, patch, options_).Run(start);
}

}  // namespace floorloc
