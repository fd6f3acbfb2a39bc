// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/quality.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "mapbuilder/report/zones.h"

namespace floorloc {
namespace {

double ViewArea(const MapEvidence& evidence) {
  const RectM& roi = evidence.map.info.camera().floor.roi;
  return roi.width_m() * roi.height_m();
}

FloorGrid MakeGrid(const MapEvidence& evidence, const QualityOptions& options, double view_m2) {
  const double wanted_m = std::sqrt(view_m2) / options.cells_per_view;
  const double least_m = std::sqrt(std::max(evidence.map.info.area_m2, view_m2) / options.max_cells);
  // The extent can be much larger than its floor, e.g. for a ring or a long diagonal.
  const RectM extent = ExtentWithLostFrames(evidence);
  const double box_m = std::sqrt(extent.width_m() * extent.height_m() / (10.0 * options.max_cells));
  const double side_m = std::max(extent.width_m(), extent.height_m()) / options.max_side_cells;
  const double cell_m = std::max({wanted_m, least_m, box_m, side_m});
  return {extent, cell_m, 2 + static_cast<int>(std::ceil(std::sqrt(view_m2) / cell_m))};
}

// Sums over the keypoints of each cell.
struct KeypointCells {
  std::vector<float> all, usable, observed_once, duplicates, distinctiveness;
};

KeypointCells CountKeypoints(const MapKeypoints& keypoints, const FloorGrid& grid, const QualityOptions& options) {
  KeypointCells cells;
  for (auto* sums : {&cells.all, &cells.usable, &cells.observed_once, &cells.duplicates, &cells.distinctiveness}) {
    sums->assign(grid.size(), 0.0F);
  }
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const auto cell = grid.CellAt(keypoints.PositionInMap(i));
    if (!cell) {
      continue;
    }
    const bool once = keypoints.observations[i] < 2;
    const bool duplicate = keypoints.distinctiveness[i] < options.duplicate_below;
    cells.all[*cell] += 1.0F;
    cells.observed_once[*cell] += once ? 1.0F : 0.0F;
    cells.duplicates[*cell] += duplicate ? 1.0F : 0.0F;
    cells.usable[*cell] +=
        static_cast<float>((once ? options.weight_observed_once : 1.0) * (duplicate ? options.weight_duplicate : 1.0));
    cells.distinctiveness[*cell] += static_cast<float>(keypoints.distinctiveness[i]) / 255.0F;
  }
  return cells;
}

std::vector<int> CountFrames(const MapEvidence& evidence, const FloorGrid& grid) {
  std::vector<int> coverage(grid.size(), 0);
  for (const MapFrame& frame : evidence.frames) {
    for (const std::size_t cell : grid.CellsInView(frame.map_from_base, evidence.RoiOf(frame))) {
      ++coverage[cell];
    }
  }
  return coverage;
}

std::vector<float> Covered(const std::vector<int>& coverage) {
  std::vector<float> covered(coverage.size());
  std::transform(coverage.begin(), coverage.end(), covered.begin(), [](int n) { return n > 0 ? 1.0F : 0.0F; });
  return covered;
}

// Assesses the view of a frame centred on each cell; the window is a square of the view's area.
void AssessViews(const KeypointCells& cells, const QualityOptions& options, MapQuality* quality) {
  const FloorGrid& grid = quality->grid;
  const int half =
      std::max(0, static_cast<int>(std::lround(0.5 * (std::sqrt(quality->view_m2) / grid.cell_m() - 1.0))));
  const auto window_cells = static_cast<float>((2 * half + 1) * (2 * half + 1));
  const auto view_cells = static_cast<float>(quality->view_m2 / grid.cell_m2());
  const std::vector<float> covered = grid.WindowSums(Covered(quality->coverage), half);
  const std::vector<float> all = grid.WindowSums(cells.all, half);
  const std::vector<float> once = grid.WindowSums(cells.observed_once, half);
  const std::vector<float> duplicates = grid.WindowSums(cells.duplicates, half);
  const std::vector<float> usable = grid.WindowSums(cells.usable, half);
  const std::vector<float> distinct = grid.WindowSums(cells.distinctiveness, half);
  const auto lost_once = static_cast<float>(1.0 - options.weight_observed_once);
  const auto lost_duplicate = static_cast<float>(1.0 - options.weight_duplicate);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    quality->distinctiveness[cell] =
        all[cell] > 0.0F && quality->coverage[cell] > 0 ? distinct[cell] / all[cell] : -1.0F;
    if (quality->coverage[cell] == 0 || covered[cell] < static_cast<float>(options.min_share_in_view) * window_cells) {
      continue;
    }
    const float scale = view_cells / covered[cell];
    quality->usable_in_view[cell] = scale * usable[cell];
    if (static_cast<double>(quality->usable_in_view[cell]) >= options.needed_keypoints) {
      continue;
    }
    const bool few = static_cast<double>(scale * all[cell]) < options.needed_keypoints;
    const bool self_similar = lost_duplicate * duplicates[cell] > lost_once * once[cell];
    quality->weakness[cell] = few            ? Weakness::kFewKeypoints
                              : self_similar ? Weakness::kSelfSimilar
                                             : Weakness::kObservedOnce;
  }
}

// Count per square metre, smoothed over a quarter of a view; negative where no frame covers the floor.
std::vector<float> Density(const std::vector<float>& count, const MapQuality& quality) {
  const FloorGrid& grid = quality.grid;
  std::vector<float> density(grid.size(), -1.0F);
  const int half = std::max(0, static_cast<int>(std::lround(0.125 * std::sqrt(quality.view_m2) / grid.cell_m())));
  const std::vector<float> sums = grid.WindowSums(count, half);
  const std::vector<float> covered = grid.WindowSums(Covered(quality.coverage), half);
  const auto cell_m2 = static_cast<float>(grid.cell_m2());
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (quality.coverage[cell] > 0) {
      density[cell] = sums[cell] / (covered[cell] * cell_m2);
    }
  }
  return density;
}

// Finds uncovered floor that is enclosed by surveyed floor or narrower than a view.
void FindHoles(const QualityOptions& options, MapQuality* quality) {
  const FloorGrid& grid = quality->grid;
  cv::Mat covered(grid.rows(), grid.columns(), CV_8U);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    covered.at<std::uint8_t>(grid.Row(cell), grid.Column(cell)) = quality->coverage[cell] > 0 ? 255 : 0;
  }
  const int radius = std::max(1, static_cast<int>(std::lround(0.5 * std::sqrt(quality->view_m2) / grid.cell_m())));
  cv::Mat closed;
  cv::morphologyEx(covered, closed, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1)));
  cv::Mat labels, statistics, centroids;
  cv::connectedComponentsWithStats(covered == 0, labels, statistics, centroids, 4);
  const int outside = labels.at<int>(0, 0);
  const double largest = options.max_hole_views * quality->view_m2 / grid.cell_m2();
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const int row = grid.Row(cell), column = grid.Column(cell);
    if (covered.at<std::uint8_t>(row, column) != 0) {
      continue;
    }
    const int label = labels.at<int>(row, column);
    const bool large = label != outside && statistics.at<int>(label, cv::CC_STAT_AREA) > largest;
    quality->furniture_m2 += large ? grid.cell_m2() : 0.0;
    if (closed.at<std::uint8_t>(row, column) != 0 || (label != outside && !large)) {
      quality->weakness[cell] = Weakness::kNotSurveyed;
    }
  }
}

void MeasureStrain(const MapEvidence& evidence, MapQuality* quality) {
  quality->frame_error_m.assign(evidence.frames.size(), 0.0);
  quality->frame_sigma.assign(evidence.frames.size(), 0.0);
  quality->frame_links.assign(evidence.frames.size(), 0);
  for (const MapLink& link : evidence.links) {
    const MapFrame& first = evidence.frames[static_cast<std::size_t>(link.first)];
    const MapFrame& second = evidence.frames[static_cast<std::size_t>(link.second)];
    const Eigen::Vector2d view = evidence.RoiOf(second).Center();
    const Eigen::Vector2d by_poses = first.map_from_base.Between(second.map_from_base) * view;
    const LinkStrain strain{(link.first_from_second * view - by_poses).norm(), link.residual_sigma};
    quality->link_strain.push_back(strain);
    for (const int frame : {link.first, link.second}) {
      const auto i = static_cast<std::size_t>(frame);
      quality->frame_error_m[i] += strain.error_m * strain.error_m;
      quality->frame_sigma[i] += strain.sigma * strain.sigma;
      ++quality->frame_links[i];
    }
  }
  for (std::size_t i = 0; i < evidence.frames.size(); ++i) {
    const double links = std::max(1, quality->frame_links[i]);
    quality->frame_error_m[i] = std::sqrt(quality->frame_error_m[i] / links);
    quality->frame_sigma[i] = std::sqrt(quality->frame_sigma[i] / links);
  }
}

void MarkStrained(const MapEvidence& evidence, const QualityOptions& options, MapQuality* quality) {
  for (std::size_t i = 0; i < evidence.frames.size(); ++i) {
    const MapFrame& frame = evidence.frames[i];
    const double pixel_m = evidence.map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.resolution_m;
    if (quality->frame_sigma[i] <= options.strained_sigma ||
        quality->frame_error_m[i] <= options.strained_px * pixel_m) {
      continue;
    }
    for (const std::size_t cell : quality->grid.CellsInView(frame.map_from_base, evidence.RoiOf(frame))) {
      if (quality->weakness[cell] == Weakness::kNone) {
        quality->weakness[cell] = Weakness::kStrained;
      }
    }
  }
}

double AreaOf(const std::vector<float>& covered, const FloorGrid& grid) {
  return grid.cell_m2() * static_cast<double>(std::count(covered.begin(), covered.end(), 1.0F));
}

}  // namespace

void QualityOptions::Check() const {
  if (!(cells_per_view >= 1.0) || !(max_cells >= 100.0)) {
    throw std::invalid_argument("cells_per_view must be at least 1 and max_cells at least 100");
  }
  if (!(needed_keypoints >= 0.0) || !(min_share_in_view > 0.0 && min_share_in_view <= 1.0)) {
    throw std::invalid_argument("needed_keypoints must not be negative and min_share_in_view lie in (0, 1]");
  }
}

MapQuality MeasureQuality(const MapEvidence& evidence, const QualityOptions& options) {
  options.Check();
  MapQuality quality;
  quality.view_m2 = ViewArea(evidence);
  quality.drawing_origin_m = DrawingOrigin(evidence);
  quality.grid = MakeGrid(evidence, options, quality.view_m2);
  quality.coverage = CountFrames(evidence, quality.grid);
  for (auto* values : {&quality.usable_in_view, &quality.distinctiveness}) {
    values->assign(quality.grid.size(), -1.0F);
  }
  quality.weakness.assign(quality.grid.size(), Weakness::kNone);
  const KeypointCells cells = CountKeypoints(evidence.map.keypoints, quality.grid, options);
  quality.keypoints_m2 = Density(cells.all, quality);
  quality.usable_m2 = Density(cells.usable, quality);
  AssessViews(cells, options, &quality);
  FindHoles(options, &quality);
  MeasureStrain(evidence, &quality);
  MarkStrained(evidence, options, &quality);
  quality.surveyed_m2 = AreaOf(Covered(quality.coverage), quality.grid);
  quality.judged_m2 = quality.grid.cell_m2() *
                      static_cast<double>(std::count_if(quality.usable_in_view.begin(), quality.usable_in_view.end(),
                                                        [](float usable) { return usable >= 0.0F; }));
  CollectZones(evidence, options, &quality);
  return quality;
}

}  // namespace floorloc
