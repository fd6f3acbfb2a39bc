// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/zones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace floorloc {
namespace {

constexpr int kNoZone = -1;

std::vector<std::size_t> Neighbours(const FloorGrid& grid, std::size_t cell) {
  std::vector<std::size_t> neighbours;
  for (int row = grid.Row(cell) - 1; row <= grid.Row(cell) + 1; ++row) {
    for (int column = grid.Column(cell) - 1; column <= grid.Column(cell) + 1; ++column) {
      if (row >= 0 && row < grid.rows() && column >= 0 && column < grid.columns()) {
        neighbours.push_back(grid.Index(column, row));
      }
    }
  }
  return neighbours;
}

bool LacksKeypoints(Weakness weakness) {
  return weakness == Weakness::kFewKeypoints || weakness == Weakness::kObservedOnce ||
         weakness == Weakness::kSelfSimilar;
}

// A window around a weak cell may include some good floor, and the zone also includes adjacent cells that are poor by
// themselves: a view of their density alone would not have the needed keypoints.
void GrowWeakCells(const QualityOptions& options, MapQuality* quality) {
  const FloorGrid& grid = quality->grid;
  const auto needed_m2 = static_cast<float>(options.needed_keypoints / quality->view_m2);
  std::vector<std::size_t> front;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (LacksKeypoints(quality->weakness[cell])) {
      front.push_back(cell);
    }
  }
  const int steps = static_cast<int>(std::lround(0.5 * std::sqrt(quality->view_m2) / grid.cell_m()));
  for (int step = 0; step < steps; ++step) {
    std::vector<std::size_t> next;
    for (const std::size_t cell : front) {
      for (const std::size_t neighbour : Neighbours(grid, cell)) {
        if (quality->weakness[neighbour] == Weakness::kNone && quality->coverage[neighbour] > 0 &&
            quality->usable_m2[neighbour] < needed_m2) {
          quality->weakness[neighbour] = quality->weakness[cell];
          next.push_back(neighbour);
        }
      }
    }
    front = std::move(next);
  }
}

Zone Flood(std::size_t start, int label, const MapQuality& quality, std::vector<int>* labels) {
  Zone zone;
  zone.weakness = quality.weakness[start];
  zone.cells = {start};
  (*labels)[start] = label;
  for (std::size_t i = 0; i < zone.cells.size(); ++i) {
    for (const std::size_t cell : Neighbours(quality.grid, zone.cells[i])) {
      if ((*labels)[cell] == kNoZone && quality.weakness[cell] == zone.weakness) {
        (*labels)[cell] = label;
        zone.cells.push_back(cell);
      }
    }
  }
  return zone;
}

// Measures area, bounding box, and the cell nearest to the centre.
void Measure(const MapQuality& quality, Zone* zone) {
  const FloorGrid& grid = quality.grid;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  bool judged = false;
  constexpr double kFar = std::numeric_limits<double>::max();
  zone->box = {kFar, -kFar, kFar, -kFar};
  const double half_m = 0.5 * grid.cell_m();
  for (const std::size_t cell : zone->cells) {
    const Eigen::Vector2d p = grid.Center(cell);
    sum += p;
    zone->box = {std::min(zone->box.x_min, p.x() - half_m), std::max(zone->box.x_max, p.x() + half_m),
                 std::min(zone->box.y_min, p.y() - half_m), std::max(zone->box.y_max, p.y() + half_m)};
    if (quality.usable_in_view[cell] >= 0.0F) {
      const auto usable = static_cast<double>(quality.usable_in_view[cell]);
      zone->usable_in_view = judged ? std::min(zone->usable_in_view, usable) : usable;
      judged = true;
    }
  }
  const auto count = static_cast<double>(zone->cells.size());
  zone->area_m2 = count * grid.cell_m2();
  const Eigen::Vector2d mean = sum / count;
  const auto nearest = std::min_element(zone->cells.begin(), zone->cells.end(), [&](std::size_t a, std::size_t b) {
    return (grid.Center(a) - mean).squaredNorm() < (grid.Center(b) - mean).squaredNorm();
  });
  zone->mark = grid.Center(*nearest);
}

// The view of a failed held-out frame is a zone of its own unless another weakness explains it. A dropped frame's view
// that no other frame covers is missing floor, even at the survey's edge.
void MarkFailures(const MapEvidence& evidence, MapQuality* quality) {
  const RectM& roi = evidence.map.info.camera().floor.roi;
  for (const DroppedFrame& frame : evidence.build.dropped) {
    if (frame.near) {
      for (const std::size_t cell : quality->grid.CellsInView(*frame.near, roi)) {
        quality->weakness[cell] = quality->coverage[cell] == 0 ? Weakness::kNotSurveyed : quality->weakness[cell];
      }
    }
  }
  for (const HeldOutFrame& frame : evidence.build.held_out) {
    const std::vector<std::size_t> view = quality->grid.CellsInView(frame.map_from_base, roi);
    const bool explained = std::any_of(view.begin(), view.end(), [&](std::size_t cell) {
      return quality->weakness[cell] != Weakness::kNone && quality->weakness[cell] != Weakness::kNotFound;
    });
    for (const std::size_t cell : view) {
      if (frame.status != "localized" && !explained) {
        quality->weakness[cell] = Weakness::kNotFound;
      }
    }
  }
}

// The zone with most of a view's weak cells.
int ZoneOfView(const std::vector<std::size_t>& view, const std::vector<int>& labels) {
  std::unordered_map<int, int> votes;
  int best = kNoZone, max_votes = 0;
  for (const std::size_t cell : view) {
    if (labels[cell] != kNoZone && ++votes[labels[cell]] > max_votes) {
      best = labels[cell];
      max_votes = votes[best];
    }
  }
  return best;
}

void CountFailures(const MapEvidence& evidence, const std::vector<int>& labels, MapQuality* quality) {
  const RectM& roi = evidence.map.info.camera().floor.roi;
  const auto zone_at = [&](const Pose2& pose) -> Zone* {
    const int label = ZoneOfView(quality->grid.CellsInView(pose, roi), labels);
    return label == kNoZone ? nullptr : &quality->zones[static_cast<std::size_t>(label)];
  };
  for (const HeldOutFrame& frame : evidence.build.held_out) {
    if (Zone* zone = frame.status == "localized" ? nullptr : zone_at(frame.map_from_base)) {
      ++zone->held_out_failures;
    }
  }
  for (const DroppedFrame& frame : evidence.build.dropped) {
    if (Zone* zone = frame.near ? zone_at(*frame.near) : nullptr) {
      ++zone->lost_frames;
    }
  }
}

// Severity of a view of such floor, relative to a hole in the map, where no frame can be localized.
double Weight(const Zone& zone, const QualityOptions& options) {
  switch (zone.weakness) {
    case Weakness::kFewKeypoints:
      return 1.0 - 0.8 * std::min(1.0, zone.usable_in_view / options.needed_keypoints);
    case Weakness::kNotSurveyed:
    case Weakness::kStrained:
      return 1.0;
    case Weakness::kNotFound:
      return 0.8;
    case Weakness::kObservedOnce:
      return 0.5;
    case Weakness::kSelfSimilar:
      return 0.4;
    case Weakness::kNone:
      break;
  }
  return 0.0;
}

bool IsReportable(const Zone& zone, const QualityOptions& options, double view_m2) {
  return zone.area_m2 >= options.min_zone_views * view_m2 || zone.held_out_failures > 0;
}

}  // namespace

void CollectZones(const MapEvidence& evidence, const QualityOptions& options, MapQuality* quality) {
  GrowWeakCells(options, quality);
  MarkFailures(evidence, quality);
  std::vector<int> labels(quality->grid.size(), kNoZone);
  for (std::size_t cell = 0; cell < quality->grid.size(); ++cell) {
    if (quality->weakness[cell] != Weakness::kNone && labels[cell] == kNoZone) {
      quality->zones.push_back(Flood(cell, static_cast<int>(quality->zones.size()), *quality, &labels));
    }
  }
  CountFailures(evidence, labels, quality);
  for (Zone& zone : quality->zones) {
    Measure(*quality, &zone);
    zone.importance =
        Weight(zone, options) * zone.area_m2 / quality->view_m2 + 2.0 * zone.held_out_failures + 0.3 * zone.lost_frames;
    if (!IsReportable(zone, options, quality->view_m2)) {
      for (const std::size_t cell : zone.cells) {
        quality->weakness[cell] = Weakness::kNone;
      }
    } else if (zone.weakness != Weakness::kNotSurveyed) {
      quality->weak_m2 += zone.area_m2;
    }
  }
  std::erase_if(quality->zones, [&](const Zone& zone) { return !IsReportable(zone, options, quality->view_m2); });
  std::stable_sort(quality->zones.begin(), quality->zones.end(),
                   [](const Zone& a, const Zone& b) { return a.importance > b.importance; });
}

}  // namespace floorloc
