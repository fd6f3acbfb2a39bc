// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/measured_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

std::string Text(const MeasuredDistance& distance) {
  char text[160];
  std::snprintf(text, sizeof(text), "--distance %.3f,%.3f,%.3f,%.3f,%.4g", distance.first_m.x(), distance.first_m.y(),
                distance.second_m.x(), distance.second_m.y(), distance.distance_m);
  return text;
}

// A place in an image.
struct Sight {
  std::size_t frame = 0;
  Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();
};

// The frame of a survey in whose view the place is nearest to the middle.
std::optional<Sight> BestSight(const CalibratedFrames& map, std::size_t survey, const Eigen::Vector2d& place_m) {
  std::optional<Sight> best;
  double nearest_m = 0.0;
  for (std::size_t i = 0; i < map.set.frames.size(); ++i) {
    const BuildFrame& frame = map.set.frames[i];
    const std::optional<Pose2>& pose = map.placement.map_from_base[i];
    if (frame.survey != static_cast<int>(survey) || !pose) {
      continue;
    }
    const FloorCamera camera = CameraOf(frame, map.set.surveys);
    const Eigen::Vector2d in_base = pose->Inverse() * place_m;
    const double off_m = (in_base - camera.floor.roi.Center()).norm();
    if (!camera.floor.roi.Contains(in_base) || (best && off_m >= nearest_m)) {
      continue;
    }
    const Eigen::Vector2d px = RawPixelOf(frame, map.set.surveys, in_base);
    if (px.minCoeff() >= 0.0 && px.x() <= camera.camera.width_px - 1 && px.y() <= camera.camera.height_px - 1) {
      best = Sight{i, px};
      nearest_m = off_m;
    }
  }
  return best;
}

// Throws InputError: which place is not in the map.
[[noreturn]] void RefuseUnseen(const CalibratedFrames& map, const MeasuredDistance& distance) {
  for (const Eigen::Vector2d& place : {distance.first_m, distance.second_m}) {
    bool seen = false;
    for (std::size_t s = 0; s < map.set.surveys.size(); ++s) {
      seen = seen || BestSight(map, s, place);
    }
    if (!seen) {
      char text[160];
      std::snprintf(text, sizeof(text),
                    ": the map has no floor at (%.3f, %.3f); give two places of the map that this build makes without "
                    "it",
                    place.x(), place.y());
      throw InputError(Text(distance) + text);
    }
  }
  throw InputError(Text(distance) + ": no survey shows both places; measure between two places of one survey");
}

void RequirePlausible(const MeasuredDistance& distance, double max_scale) {
  const double in_map_m = (distance.first_m - distance.second_m).norm();
  if (std::abs(std::log(distance.distance_m / in_map_m)) > std::log(max_scale)) {
    char text[200];
    std::snprintf(text, sizeof(text),
                  ": the images put the places %.3f m apart (%.3g times as far); check the places and the unit, metres",
                  in_map_m, in_map_m / distance.distance_m);
    throw InputError(Text(distance) + text);
  }
}

double ReadingSigma(const FloorCamera& camera, const DistanceOptions& options) {
  const double place_m = options.reading_px * camera.floor.resolution_m;
  return std::sqrt(options.sigma_m * options.sigma_m + 2.0 * place_m * place_m);
}

}  // namespace

MeasuredDistance ParseMeasuredDistance(const std::string& text) {
  std::array<double, 5> values{};
  std::istringstream in(text);
  std::size_t count = 0;
  for (std::string field; std::getline(in, field, ',') && count < values.size(); ++count) {
    std::size_t used = 0;
    try {
      values[count] = std::stod(field, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != field.size() || !std::isfinite(values[count])) {
      throw std::invalid_argument("'" + text +
                                  "' is no distance: give x1,y1,x2,y2,metres, such as 0.5,0.5,39.5,0.5,38.98");
    }
  }
  MeasuredDistance distance{{values[0], values[1]}, {values[2], values[3]}, values[4]};
  if (count != values.size() || std::count(text.begin(), text.end(), ',') != 4) {
    throw std::invalid_argument("'" + text +
                                "' is no distance: give x1,y1,x2,y2,metres, such as 0.5,0.5,39.5,0.5,38.98");
  }
  if (distance.distance_m <= 0.0 || distance.first_m == distance.second_m) {
    throw std::invalid_argument("'" + text + "': the distance must be positive, and between two places");
  }
  return distance;
}

void DistanceOptions::Check() const {
  RequireOption(sigma_m > 0.0, "sigma_m must be positive");
  RequireOption(reading_px >= 0.0, "reading_px must not be negative");
  RequireOption(max_scale > 1.0, "max_scale must be above 1");
  RequireOption(named_sigmas > 0.0, "named_sigmas must be positive");
}

FrameSet WithMeasuredDistances(FrameSet set, const CalibratedFrames& map, const DistanceOptions& options) {
  options.Check();
  for (const MeasuredDistance& distance : options.distances) {
    bool added = false;
    for (std::size_t s = 0; s < set.surveys.size() && !added; ++s) {
      const auto first = BestSight(map, s, distance.first_m);
      const auto second = BestSight(map, s, distance.second_m);
      if (first && second) {
        set.surveys[s].survey.known_distances.push_back({map.set.frames[first->frame].info.filename, first->raw_px,
                                                         map.set.frames[second->frame].info.filename, second->raw_px,
                                                         distance.distance_m});
        added = true;
      }
    }
    if (!added) {
      RefuseUnseen(map, distance);
    }
    RequirePlausible(distance, options.max_scale);
  }
  return set;
}

std::vector<DistanceMisfit> CompareDistances(const CalibratedFrames& map, const DistanceOptions& options) {
  std::map<std::pair<int, std::string>, std::size_t> by_name;
  for (std::size_t i = 0; i < map.set.frames.size(); ++i) {
    by_name[{map.set.frames[i].survey, map.set.frames[i].info.filename}] = i;
  }
  std::vector<DistanceMisfit> misfits;
  for (std::size_t s = 0; s < map.set.surveys.size(); ++s) {
    const auto seen = [&](const std::string& file, const Eigen::Vector2d& px) -> std::optional<Eigen::Vector2d> {
      const auto frame = by_name.find({static_cast<int>(s), file});
      if (frame == by_name.end() || !map.placement.map_from_base[frame->second]) {
        return std::nullopt;
      }
      return *map.placement.map_from_base[frame->second] *
             FloorPointOf(map.set.frames[frame->second], map.set.surveys, px);
    };
    for (const KnownDistance& known : map.set.surveys[s].survey.known_distances) {
      const auto a = seen(known.first_filename, known.first_raw_px);
      const auto b = seen(known.second_filename, known.second_raw_px);
      if (a && b) {
        misfits.push_back(
            {"the distance between a place in " + known.first_filename + " and one in " + known.second_filename,
             known.distance_m, (*a - *b).norm(), ReadingSigma(map.set.surveys[s].survey.camera, options)});
      }
    }
  }
  return misfits;
}

std::vector<std::string> NameMisfits(const std::vector<DistanceMisfit>& misfits, const DistanceOptions& options) {
  std::vector<std::string> sentences;
  for (const DistanceMisfit& misfit : misfits) {
    const double off_m = misfit.seen_m - misfit.known_m;
    if (std::abs(off_m) > options.named_sigmas * misfit.sigma_m) {
      char text[200];
      std::snprintf(text, sizeof(text),
                    " was measured as %.3f m, and is %.1f mm %s in the map: it contradicts other distances, control "
                    "points or the camera's height; measure it again",
                    misfit.known_m, 1e3 * std::abs(off_m), off_m > 0.0 ? "longer" : "shorter");
      sentences.push_back(misfit.what + text);
    }
  }
  return sentences;
}

}  // namespace floorloc
