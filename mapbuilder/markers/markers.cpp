// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/markers/markers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <numeric>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/markers/marker_positions.h"

namespace floorloc {
namespace {

// Detections that are less square are not markers on the floor; those of another size are other markers.
constexpr double kSquareTolerance = 0.06;
constexpr double kSizeTolerance = 0.1;
// Deviation of all markers' size from which on the scale is wrong or doubtful, relative.
constexpr double kWrongScale = 0.05;
constexpr double kDoubtfulScale = 0.015;

// Two markers that disagree by more than twice this cause a warning.
constexpr double kMaxPairErrorM = 0.005;

constexpr double kWrongYawRad = 5.0 * std::numbers::pi / 180.0;

std::string Millimetres(double m) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f mm", 1e3 * m);
  return text;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Distance of a point from a convex polygon with clockwise corners; 0 inside.
double DistanceFrom(const std::array<Eigen::Vector2d, 4>& corners, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d side = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d to = p - corners[i];
    inside = inside && side.x() * to.y() - side.y() * to.x() <= 0.0;
    const double along = std::clamp(to.dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (to - along * side).norm());
  }
  return inside ? 0.0 : nearest;
}

void RemoveKeypointsOn(const std::array<Eigen::Vector2d, 4>& corners, double margin_m, Features* features) {
  std::vector<Keypoint> kept;
  cv::Mat descriptors;
  for (std::size_t i = 0; i < features->keypoints.size(); ++i) {
    const Keypoint& keypoint = features->keypoints[i];
    if (DistanceFrom(corners, keypoint.Position()) > margin_m + 0.5 * static_cast<double>(keypoint.size_m)) {
      kept.push_back(keypoint);
      descriptors.push_back(features->descriptors.row(static_cast<int>(i)));
    }
  }
  if (kept.size() < features->keypoints.size()) {
    features->keypoints = std::move(kept);
    features->descriptors = descriptors;
  }
}

// Corners of a marker from its map pose, in the order of MarkerDetection.
std::array<Eigen::Vector2d, 4> CornersInMap(const KnownMarker& marker, double size_m) {
  const Pose2 map_from_marker(marker.center_in_map_m.x(), marker.center_in_map_m.y(), *marker.yaw_rad);
  const double half = 0.5 * size_m;
  return {map_from_marker * Eigen::Vector2d(-half, half), map_from_marker * Eigen::Vector2d(half, half),
          map_from_marker * Eigen::Vector2d(half, -half), map_from_marker * Eigen::Vector2d(-half, -half)};
}

// Mean corners of a marker in the map over all placed frames of one survey; it may have been moved between surveys.
struct MarkerInMap {
  int id = 0;
  int frames = 0;
  std::array<Eigen::Vector2d, 4> corners_m;

  Eigen::Vector2d Center() const { return 0.25 * (corners_m[0] + corners_m[1] + corners_m[2] + corners_m[3]); }
  double Yaw() const {
    const Eigen::Vector2d x = corners_m[1] - corners_m[0] + corners_m[2] - corners_m[3];
    return std::atan2(x.y(), x.x());
  }
};

std::vector<MarkerInMap> CollectInMap(const std::vector<MarkerDetection>& detections,
                                      const std::vector<BuildFrame>& frames, const Placement& placement) {
  std::map<std::pair<int, int>, MarkerInMap> located;  // key: id, survey
  for (const MarkerDetection& detection : detections) {
    const auto frame = static_cast<std::size_t>(detection.frame);
    if (!placement.map_from_base[frame]) {
      continue;
    }
    const std::array<Eigen::Vector2d, 4> origin{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                                Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    MarkerInMap& marker =
        located.try_emplace({detection.id, frames[frame].survey}, MarkerInMap{detection.id, 0, origin}).first->second;
    ++marker.frames;
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d corner = *placement.map_from_base[frame] * detection.corners_m[i];
      marker.corners_m[i] += (corner - marker.corners_m[i]) / marker.frames;
    }
  }
  std::vector<MarkerInMap> all;
  for (const auto& [key, marker] : located) {
    all.push_back(marker);
  }
  return all;
}

double MarginOf(const MarkerOptions& options) {
  return options.margin_m >= 0.0 ? options.margin_m : 0.25 * options.detection.size_m;
}

}  // namespace

void MarkerOptions::Check() const {
  detection.Check();
  RequireOption(margin_m < 1.0, "margin_m must be below 1 m; negative: a quarter of the marker");
}

MarkerSurvey::MarkerSurvey(const MarkerOptions& options, const FrameSet& set)
    : options_(options), known_(ParseMarkersCsv(ReadTextFile(options.file), options.file)) {
  options.Check();
  for (const LoadedSurvey& loaded : set.surveys) {
    survey_control_points_.push_back(loaded.survey.control_points.size());
  }
  detections_ = DetectMarkers(set.frames, set.surveys, options.detection);
  CheckSizes();
  CheckKnownMarkers();
}

const KnownMarker* MarkerSurvey::Find(int id) const {
  const auto found =
      std::find_if(known_.begin(), known_.end(), [&](const KnownMarker& marker) { return marker.id == id; });
  return found == known_.end() ? nullptr : &*found;
}

void MarkerSurvey::CheckSizes() {
  const double size_m = options_.detection.size_m;
  const std::size_t all = detections_.size();
  std::erase_if(detections_, [](const MarkerDetection& detection) { return !detection.IsSquare(kSquareTolerance); });
  if (detections_.empty()) {
    throw InputError(options_.file, "no marker of " + options_.detection.dictionary +
                                        " was detected in any image; check --marker-dictionary");
  }
  std::vector<double> sides;
  for (const MarkerDetection& detection : detections_) {
    sides.push_back(detection.MeanSideM());
  }
  const double median_m = Median(sides);
  const std::string measured = "the markers measure " + Millimetres(median_m) + " in the images, not " +
                               Millimetres(size_m) +
                               ": check --marker-size (the black square) and the scale of "
                               "floor.yaml";
  if (std::abs(median_m / size_m - 1.0) > kWrongScale) {
    throw InputError(options_.file, measured);
  }
  if (std::abs(median_m / size_m - 1.0) > kDoubtfulScale) {
    warnings_.push_back(measured);
  }
  std::erase_if(detections_, [&](const MarkerDetection& detection) {
    return std::abs(detection.MeanSideM() / median_m - 1.0) > kSizeTolerance;
  });
  if (all > detections_.size()) {
    warnings_.push_back(std::to_string(all - detections_.size()) + " of " + std::to_string(all) +
                        " detections of markers are not squares of --marker-size and were not used: a marker that does "
                        "not lie flat, or a pattern that resembles one");
  }
}

void MarkerSurvey::CheckKnownMarkers() {
  std::map<int, int> count;
  for (const MarkerDetection& detection : detections_) {
    ++count[detection.id];
  }
  int fixed = 0;
  for (const KnownMarker& marker : known_) {
    if (!count.contains(marker.id)) {
      warnings_.push_back("marker " + std::to_string(marker.id) + " (" + options_.file.string() + ":" +
                          std::to_string(marker.line) + ") is in no image");
    } else {
      fixed += marker.yaw_rad ? 2 : 1;
    }
  }
  for (const auto& [id, frames] : count) {
    if (Find(id) == nullptr) {
      warnings_.push_back("marker " + std::to_string(id) + " is in " + std::to_string(frames) + " images but not in " +
                          options_.file.string() + ": it is masked, and not used otherwise");
    }
  }
  if (fixed < 2) {
    throw InputError(options_.file,
                     fixed == 0 ? "none of its markers is in the images; check the ids and --marker-dictionary"
                                : "only one of its markers is in the images, which does not fix the map's heading; "
                                  "survey two, or give its yaw");
  }
}

FrameSet MarkerSurvey::MaskDetected(FrameSet set) const {
  for (const MarkerDetection& detection : detections_) {
    RemoveKeypointsOn(detection.corners_m, MarginOf(options_),
                      &set.frames[static_cast<std::size_t>(detection.frame)].features);
  }
  return set;
}

void MarkerSurvey::MultiplyHeights(double factor, const FrameSet& set) {
  for (MarkerDetection& detection : detections_) {
    const BuildFrame& frame = set.frames[static_cast<std::size_t>(detection.frame)];
    const Eigen::Vector2d below = CameraOf(frame, set.surveys).CameraCenter().head<2>();
    for (Eigen::Vector2d& corner : detection.corners_m) {
      corner = below + factor * (corner - below);
    }
  }
}

FrameSet MarkerSurvey::AddControlPoints(FrameSet set) const {
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    set.surveys[s].survey.control_points.resize(survey_control_points_[s]);
  }
  for (const MarkerDetection& detection : detections_) {
    const KnownMarker* marker = Find(detection.id);
    if (marker == nullptr || excluded_.contains(detection.id)) {
      continue;
    }
    const BuildFrame& frame = set.frames[static_cast<std::size_t>(detection.frame)];
    Survey& survey = set.surveys[static_cast<std::size_t>(frame.survey)].survey;
    const auto add = [&](const Eigen::Vector2d& in_base_m, const Eigen::Vector2d& in_map_m) {
      survey.control_points.push_back({frame.info.filename, RawPixelOf(frame, set.surveys, in_base_m), in_map_m, true});
    };
    if (!marker->yaw_rad) {
      add(detection.Center(), marker->center_in_map_m);
      continue;
    }
    const std::array<Eigen::Vector2d, 4> in_map = CornersInMap(*marker, options_.detection.size_m);
    for (std::size_t i = 0; i < 4; ++i) {
      add(detection.corners_m[i], in_map[i]);
    }
  }
  return set;
}

// A common turn is one mistake about what the yaw is, not as many as there are markers.
void MarkerSurvey::CheckYawDefinition(const std::vector<double>& yaw_errors_rad) const {
  if (const int turns = CommonQuarterTurn(yaw_errors_rad, kWrongYawRad); turns != 0) {
    throw InputError(options_.file,
                     "the yaws of all " + std::to_string(yaw_errors_rad.size()) +
                         " markers are off by the same quarter turn: add " + std::to_string(90 * turns) +
                         " degrees to each. A marker's yaw is the direction of its right side when its image is "
                         "upright as published (AprilTags: by AprilRobotics; OpenCV draws them turned by 180 degrees)");
  }
}

bool MarkerSurvey::ExcludeContradicting(const std::vector<BuildFrame>& frames, const Placement& placement) {
  std::vector<MarkerInMap> located = CollectInMap(detections_, frames, placement);
  std::erase_if(located, [&](const MarkerInMap& marker) { return Find(marker.id) == nullptr; });
  std::vector<MarkerPosition> positions;
  for (const MarkerInMap& marker : located) {
    positions.push_back({marker.Center(), Find(marker.id)->center_in_map_m});
  }
  const std::vector<double> residuals = positions.size() < 2 ? std::vector<double>{} : RobustResiduals(positions);
  for (const std::size_t i : FindContradicting(positions)) {
    if (excluded_.insert(located[i].id).second) {
      warnings_.push_back("marker " + std::to_string(located[i].id) + " (" + options_.file.string() + ":" +
                          std::to_string(Find(located[i].id)->line) + ") is off by " + Millimetres(residuals[i]) +
                          " against the other markers, and not used: was it moved, or its position mistyped?");
    }
  }
  std::vector<double> yaw_errors_rad;
  for (const MarkerInMap& marker : located) {
    if (const std::optional<double>& yaw = Find(marker.id)->yaw_rad; yaw && !excluded_.contains(marker.id)) {
      yaw_errors_rad.push_back(WrapAngle(marker.Yaw() - *yaw));
    }
  }
  CheckYawDefinition(yaw_errors_rad);
  for (const MarkerInMap& marker : located) {
    const std::optional<double>& yaw = Find(marker.id)->yaw_rad;
    if (yaw && std::abs(WrapAngle(marker.Yaw() - *yaw)) > kWrongYawRad && excluded_.insert(marker.id).second) {
      warnings_.push_back("marker " + std::to_string(marker.id) + " has another yaw than in " + options_.file.string() +
                          ", and is not used: the yaw is that of its x axis, to the right when "
                          "the marker is upright, in radians");
    }
  }
  if (positions.size() == 2 && residuals[0] > kMaxPairErrorM) {
    warnings_.push_back("markers " + std::to_string(located[0].id) + " and " + std::to_string(located[1].id) + " are " +
                        Millimetres(2.0 * residuals[0]) + " nearer or farther apart in the map than " +
                        options_.file.string() + " says: one of them was moved or mistyped, or the scale is wrong");
  }
  const bool any = std::any_of(located.begin(), located.end(),
                               [&](const MarkerInMap& marker) { return excluded_.contains(marker.id); });
  const auto left = std::count_if(located.begin(), located.end(),
                                  [&](const MarkerInMap& marker) { return !excluded_.contains(marker.id); });
  if (any && left < 2) {
    throw InputError(options_.file, "its markers contradict each other; measure their positions again");
  }
  return any;
}

FrameSet MarkerSurvey::MaskInMap(const Placement& placement, FrameSet set) const {
  for (const MarkerInMap& marker : CollectInMap(detections_, set.frames, placement)) {
    for (std::size_t i = 0; i < set.frames.size(); ++i) {
      if (!placement.map_from_base[i]) {
        continue;
      }
      const Pose2 base_from_map = placement.map_from_base[i]->Inverse();
      std::array<Eigen::Vector2d, 4> corners;
      std::transform(marker.corners_m.begin(), marker.corners_m.end(), corners.begin(),
                     [&](const Eigen::Vector2d& corner) { return base_from_map * corner; });
      RemoveKeypointsOn(corners, MarginOf(options_), &set.frames[i].features);
    }
  }
  return set;
}

std::vector<MarkerFit> MarkerSurvey::Fits(const std::vector<BuildFrame>& frames, const Placement& placement) const {
  std::vector<MarkerFit> fits;
  for (const MarkerInMap& marker : CollectInMap(detections_, frames, placement)) {
    const KnownMarker* known = Find(marker.id);
    MarkerFit fit{marker.id, known != nullptr, known != nullptr && !excluded_.contains(marker.id), marker.frames, 0.0};
    if (known != nullptr) {
      fit.error_m = (marker.Center() - known->center_in_map_m).norm();
    }
    fits.push_back(fit);
  }
  return fits;
}

}  // namespace floorloc
