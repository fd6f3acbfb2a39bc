// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/exposure.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/mosaic/exposure_grid.h"

namespace floorloc {
namespace {

constexpr double kMaxGain = 4.0;

double Median(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

double LogGray(const cv::Vec3b& color) { return std::log((color[0] + color[1] + color[2]) / 3.0); }

bool IsValid(const cv::Vec3b& color) { return color[1] > 0; }

// Log brightness of every cell relative to its frame's median: the median over the survey's frames.
cv::Mat LogFlatField(const std::vector<cv::Mat>& cell_colors, const cv::Size& cells) {
  constexpr std::size_t kMaxFrames = 500;
  const std::size_t step = cell_colors.size() / kMaxFrames + 1;
  std::vector<std::vector<double>> relative(static_cast<std::size_t>(cells.area()));
  for (std::size_t i = 0; i < cell_colors.size(); i += step) {
    std::vector<double> all;
    std::for_each(cell_colors[i].begin<cv::Vec3b>(), cell_colors[i].end<cv::Vec3b>(), [&](const cv::Vec3b& color) {
      if (IsValid(color)) {
        all.push_back(LogGray(color));
      }
    });
    if (all.empty()) {
      continue;
    }
    const double middle = Median(&all);
    for (std::size_t c = 0; c < relative.size(); ++c) {
      const auto& color =
          cell_colors[i].at<cv::Vec3b>(static_cast<int>(c) / cells.width, static_cast<int>(c) % cells.width);
      if (IsValid(color)) {
        relative[c].push_back(LogGray(color) - middle);
      }
    }
  }
  cv::Mat field = cv::Mat::zeros(cells, CV_32F);
  for (std::size_t c = 0; c < relative.size(); ++c) {
    if (!relative[c].empty()) {
      // Shrinks cells with few samples towards 0: what few frames have in common may be the floor.
      constexpr double kDoubt = 4.0;
      const double n = static_cast<double>(relative[c].size());
      field.at<float>(static_cast<int>(c) / cells.width, static_cast<int>(c) % cells.width) =
          static_cast<float>(Median(&relative[c]) * n / (n + kDoubt));
    }
  }
  return field;
}

// Resamples to one gain per pixel of the rectified image.
cv::Mat GainField(const cv::Mat& log_field, const ExposureGrid& grid) {
  // The centre of cell (0, 0) is half a cell from the image corner.
  constexpr double kCell = ExposureGrid::kCellPx;
  const cv::Mat cell_from_pixel =
      (cv::Mat_<double>(2, 3) << 1.0 / kCell, 0.0, 0.5 / kCell - 0.5, 0.0, 1.0 / kCell, 0.5 / kCell - 0.5);
  cv::Mat wide;
  cv::warpAffine(log_field, wide, cell_from_pixel, cv::Size(grid.ground.width_px, grid.ground.height_px),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::Mat gain;
  cv::exp(-wide, gain);
  return cv::max(cv::min(gain, kMaxGain), 1.0 / kMaxGain);
}

// One equation: log gain of `first` minus that of `second`; second = -1 stands for a known exposure.
struct GainDifference {
  int first = 0;
  int second = 0;
  Eigen::Vector3d log_ratio = Eigen::Vector3d::Zero();  // of blue, green, red
};

class GainSolver {
 public:
  GainSolver(const ExposureInput& input, const std::vector<cv::Mat>& cell_colors,
             const std::vector<ExposureGrid>& grids, const std::vector<cv::Mat>& log_fields)
      : input_(input), cell_colors_(cell_colors), grids_(grids), log_fields_(log_fields) {}

  // Log gains, one row per frame.
  Eigen::MatrixX3d Solve() const {
    std::vector<std::optional<GainDifference>> found(input_.links.size() + cell_colors_.size());
    ParallelFor(static_cast<int>(found.size()), input_.run.threads, [&](int index) {
      const auto i = static_cast<std::size_t>(index);
      found[i] = i < input_.links.size() ? Compare(input_.links[i])
                                         : CompareToBackground(static_cast<int>(i - input_.links.size()));
    });
    std::vector<GainDifference> differences;
    for (const auto& difference : found) {
      if (difference) {
        differences.push_back(*difference);
      }
    }
    return RobustLeastSquares(differences);
  }

 private:
  // Log colour of a cell corrected by the flat field.
  Eigen::Vector3d LogColor(int frame, int u, int v) const {
    const auto i = static_cast<std::size_t>(frame);
    const auto& color = cell_colors_[i].at<cv::Vec3b>(v, u);
    const double flat = log_fields_[static_cast<std::size_t>(input_.frames[i].survey)].at<float>(v, u);
    return Eigen::Vector3d(std::log(color[0]), std::log(color[1]), std::log(color[2])).array() - flat;
  }

  const ExposureGrid& GridOf(int frame) const {
    return grids_[static_cast<std::size_t>(input_.frames[static_cast<std::size_t>(frame)].survey)];
  }

  // Calls visit(u, v, point in base) for the valid cells of a frame.
  template <typename Visit>
  void ForEachCell(int frame, const Visit& visit) const {
    const cv::Mat& cell_colors = cell_colors_[static_cast<std::size_t>(frame)];
    for (int v = 0; v < cell_colors.rows; ++v) {
      for (int u = 0; u < cell_colors.cols; ++u) {
        if (IsValid(cell_colors.at<cv::Vec3b>(v, u))) {
          visit(u, v, GridOf(frame).BaseFromCell(u, v));
        }
      }
    }
  }

  // Median ratios, robust against shadows on less than half of the shared floor. Empty when too few cells are shared.
  static std::optional<Eigen::Vector3d> MedianOf(std::array<std::vector<double>, 3>* ratios) {
    constexpr std::size_t kMinCells = 8;
    if (ratios->front().size() < kMinCells) {
      return std::nullopt;
    }
    return Eigen::Vector3d(Median(&(*ratios)[0]), Median(&(*ratios)[1]), Median(&(*ratios)[2]));
  }

  std::optional<GainDifference> Compare(const Link& link) const {
    std::array<std::vector<double>, 3> ratios;
    const cv::Mat& first = cell_colors_[static_cast<std::size_t>(link.first)];
    ForEachCell(link.second, [&](int u, int v, const Eigen::Vector2d& point) {
      const Eigen::Vector2d cell = GridOf(link.first).CellFromBase(link.first_from_second * point);
      const auto fu = static_cast<int>(std::lround(cell.x()));
      const auto fv = static_cast<int>(std::lround(cell.y()));
      if (fu >= 0 && fv >= 0 && fu < first.cols && fv < first.rows && IsValid(first.at<cv::Vec3b>(fv, fu))) {
        const Eigen::Vector3d ratio = LogColor(link.second, u, v) - LogColor(link.first, fu, fv);
        for (std::size_t c = 0; c < 3; ++c) {
          ratios[c].push_back(ratio[static_cast<Eigen::Index>(c)]);
        }
      }
    });
    const auto median = MedianOf(&ratios);
    return median ? std::optional(GainDifference{link.first, link.second, *median}) : std::nullopt;
  }

  std::optional<GainDifference> CompareToBackground(int frame) const {
    const auto& pose = input_.map_from_base[static_cast<std::size_t>(frame)];
    if (!input_.background || !pose) {
      return std::nullopt;
    }
    Eigen::AlignedBox2d box;
    ForEachCell(frame, [&](int, int, const Eigen::Vector2d& point) { box.extend(*pose * point); });
    if (box.isEmpty()) {
      return std::nullopt;
    }
    const double cell_m = GridOf(frame).ground.resolution_m * ExposureGrid::kCellPx;
    const auto side_px = static_cast<int>(std::ceil(box.sizes().maxCoeff() / cell_m)) + 1;
    const RectM square{box.min().x(), box.min().x() + side_px * cell_m, box.min().y(),
                       box.min().y() + side_px * cell_m};
    const MosaicPatch older = input_.background(square, side_px);
    std::array<std::vector<double>, 3> ratios;
    ForEachCell(frame, [&](int u, int v, const Eigen::Vector2d& point) {
      const Eigen::Vector2d p = *pose * point;
      const auto column = static_cast<int>((p.x() - square.x_min) / cell_m);
      const auto row = static_cast<int>((square.y_max - p.y()) / cell_m);
      const cv::Rect inside(cv::Point(), older.bgr.size());
      if (inside.contains({column, row}) && older.valid.at<std::uint8_t>(row, column) != 0) {
        const auto& color = older.bgr.at<cv::Vec3b>(row, column);
        const Eigen::Vector3d own = LogColor(frame, u, v);
        for (std::size_t c = 0; c < 3; ++c) {
          ratios[c].push_back(std::log(std::max<int>(color[static_cast<int>(c)], 1)) -
                              own[static_cast<Eigen::Index>(c)]);
        }
      }
    });
    const auto median = MedianOf(&ratios);
    return median ? std::optional(GainDifference{frame, -1, *median}) : std::nullopt;
  }

  // Minimises the sum of rho(g_first - g_second - log ratio) + small * g^2 over the log gains g by iterative
  // reweighting; rho is that of Geman and McClure.
  Eigen::MatrixX3d RobustLeastSquares(const std::vector<GainDifference>& differences) const {
    const auto n = static_cast<Eigen::Index>(cell_colors_.size());
    Eigen::MatrixX3d gains = Eigen::MatrixX3d::Zero(n, 3);
    std::vector<double> weights(differences.size(), 1.0);
    constexpr int kRounds = 4;
    for (int round = 0; round < kRounds; ++round) {
      gains = LeastSquares(differences, weights);
      for (std::size_t i = 0; i < differences.size(); ++i) {
        constexpr double kUsual = 0.05;
        const double off = Residual(differences[i], gains).norm() / kUsual;
        weights[i] = 1.0 / std::pow(1.0 + off * off, 2.0);
      }
    }
    return gains;
  }

  static Eigen::Vector3d Residual(const GainDifference& d, const Eigen::MatrixX3d& gains) {
    Eigen::Vector3d residual = gains.row(d.first).transpose() - d.log_ratio;
    if (d.second >= 0) {
      residual -= gains.row(d.second).transpose();
    }
    return residual;
  }

  Eigen::MatrixX3d LeastSquares(const std::vector<GainDifference>& differences,
                                const std::vector<double>& weights) const {
    const auto n = static_cast<Eigen::Index>(cell_colors_.size());
    const double pull = input_.background ? 1e-5 : 1e-2;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      entries.emplace_back(i, i, pull);
    }
    for (std::size_t i = 0; i < differences.size(); ++i) {
      const GainDifference& d = differences[i];
      entries.emplace_back(d.first, d.first, weights[i]);
      right.row(d.first) += weights[i] * d.log_ratio.transpose();
      if (d.second >= 0) {
        entries.emplace_back(d.second, d.second, weights[i]);
        entries.emplace_back(d.first, d.second, -weights[i]);
        entries.emplace_back(d.second, d.first, -weights[i]);
        right.row(d.second) -= weights[i] * d.log_ratio.transpose();
      }
    }
    Eigen::SparseMatrix<double> normal(n, n);
    normal.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    return solver.solve(right);
  }

  const ExposureInput& input_;
  const std::vector<cv::Mat>& cell_colors_;
  const std::vector<ExposureGrid>& grids_;
  const std::vector<cv::Mat>& log_fields_;
};

}  // namespace

cv::Vec3f Exposure::GainOf(std::size_t frame) const {
  const cv::Vec3f balance = white_balance.empty() ? cv::Vec3f::all(1.0F) : white_balance[frame];
  return static_cast<float>(frame_gain[frame]) * balance;
}

Exposure EstimateExposure(const ExposureInput& input) {
  Exposure exposure;
  exposure.cell_colors = MeasureCellColors({input.frames, input.surveys, input.map_from_base, input.run});
  const std::vector<ExposureGrid> grids = MakeExposureGrids(input.surveys);
  std::vector<cv::Mat> log_fields;
  for (std::size_t s = 0; s < grids.size(); ++s) {
    std::vector<cv::Mat> of_survey;
    for (std::size_t i = 0; i < input.frames.size(); ++i) {
      if (input.frames[i].survey == static_cast<int>(s)) {
        of_survey.push_back(exposure.cell_colors[i]);
      }
    }
    log_fields.push_back(LogFlatField(of_survey, grids[s].valid.size()));
    exposure.flat_field.push_back(GainField(log_fields.back(), grids[s]));
  }
  const Eigen::MatrixX3d log_gains = GainSolver(input, exposure.cell_colors, grids, log_fields).Solve();
  for (Eigen::Index i = 0; i < log_gains.rows(); ++i) {
    const double mean = log_gains.row(i).mean();
    exposure.frame_gain.push_back(std::clamp(std::exp(mean), 1.0 / kMaxGain, kMaxGain));
    const Eigen::Vector3f balance =
        (log_gains.row(i).transpose().array() - mean).exp().cwiseMax(0.5).cwiseMin(2.0).matrix().cast<float>();
    exposure.white_balance.emplace_back(balance.x(), balance.y(), balance.z());
  }
  return exposure;
}

}  // namespace floorloc
