// SPDX-License-Identifier: Apache-2.0
#include "server/serving/success_map.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {

void SuccessOptions::Check() const {
  RequireOption(square_m > 0.0, "square_m must be positive");
  RequireOption(memory_images >= 2, "memory_images must be at least 2");
  RequireOption(min_found_share > 0.0 && min_found_share <= 1.0, "min_found_share must be above 0 and at most 1");
  RequireOption(min_images >= 1, "min_images must be at least 1");
  RequireOption(sigmas >= 0.0, "sigmas must not be negative");
}

std::optional<SuccessSample> SampleOf(const LocalizeJob& job, const LocalizationResult& result, bool rejected) {
  if (result.reason == NotLocalizedReason::kNoFloor) {
    return std::nullopt;
  }
  const Eigen::Vector2d middle = job.camera.rectifier->camera().floor.roi.Center();
  if (result.status == LocalizationStatus::kLocalized && !rejected) {
    return SuccessSample{result.map_from_base * middle, true, result.inliers};
  }
  SuccessSample missed;
  if (job.prior) {
    missed.place = job.prior->map_from_base * middle;
  }
  return missed;
}

// Upper bound of the share by Wilson's score interval.
bool MustSurveyAgain(const SuccessSquare& square, const SuccessOptions& options) {
  const auto n = static_cast<double>(square.found + square.missed);
  if (n < static_cast<double>(options.min_images)) {
    return false;
  }
  const double share = static_cast<double>(square.found) / n;
  const double zz = options.sigmas * options.sigmas;
  const double spread = options.sigmas * std::sqrt(share * (1.0 - share) / n + zz / (4.0 * n * n));
  return (share + zz / (2.0 * n) + spread) / (1.0 + zz / n) < options.min_found_share;
}

SuccessMap::SuccessMap(const SuccessOptions& options) : options_((options.Check(), options)) {}

void SuccessMap::Recall(const std::map<std::string, MapSuccess>& remembered) {
  const std::lock_guard lock(mutex_);
  for (const auto& [name, success] : remembered) {
    if (success.square_m == options_.square_m) {
      Counts& counts = maps_[name];
      for (const SuccessSquare& square : success.squares) {
        counts.squares[{square.y, square.x}] = square;
      }
      counts.all = success;
      counts.all.squares = {};
    }
  }
}

void SuccessMap::Add(const std::string& map, const MapInfo& info, const SuccessSample& sample, double now_s) {
  const std::lock_guard lock(mutex_);
  Counts& counts = maps_[map];
  if (counts.all.version != info.content_version) {
    counts = {{info.content_version, options_.square_m, now_s, 0, {}}, {}, {}, true};
  }
  // A prior may be anywhere; what is kept is bounded by the floor.
  if (!sample.place || !info.extent.Contains(*sample.place)) {
    if (!sample.found) {
      ++counts.all.unplaced;
      counts.head_changed = true;
    }
    return;
  }
  const Square at = {static_cast<int>(std::floor(sample.place->y() / options_.square_m)),
                     static_cast<int>(std::floor(sample.place->x() / options_.square_m))};
  SuccessSquare& square = counts.squares[at];
  square.x = at.second;
  square.y = at.first;
  ++(sample.found ? square.found : square.missed);
  square.inliers += sample.found ? sample.inliers : 0;
  if (square.found + square.missed >= options_.memory_images) {
    const std::int64_t mean = square.inliers / std::max<std::int64_t>(1, square.found);
    square.found /= 2;
    square.missed /= 2;
    square.inliers = mean * square.found;
  }
  counts.changed.insert(at);
}

MapSuccess SuccessMap::Of(const std::string& map, const std::string& version) const {
  const std::lock_guard lock(mutex_);
  const auto known = maps_.find(map);
  if (known == maps_.end() || known->second.all.version != version) {
    return {version, options_.square_m, 0.0, 0, {}};
  }
  MapSuccess success = known->second.all;
  for (const auto& [at, square] : known->second.squares) {
    success.squares.push_back(square);
  }
  return success;
}

std::map<std::string, MapSuccess> SuccessMap::TakeChanges() {
  const std::lock_guard lock(mutex_);
  std::map<std::string, MapSuccess> changes;
  for (auto& [name, counts] : maps_) {
    if (counts.head_changed || !counts.changed.empty()) {
      MapSuccess& success = changes[name] = counts.all;
      for (const Square& at : counts.changed) {
        success.squares.push_back(counts.squares.at(at));
      }
      counts.changed.clear();
      counts.head_changed = false;
    }
  }
  return changes;
}

}  // namespace floorloc
