// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/bundle_input.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "mapbuilder/keypoints/keypoint_tracks.h"

namespace floorloc {
BundleInput::BundleInput(const FrameSet& frames, const std::vector<std::optional<Pose2>>& poses)
    : set(frames), map_from_base(poses) {
  for (const LoadedSurvey& loaded : frames.surveys) {
    builders.emplace_back(loaded.survey.camera);
  }
}

void AddTracks(const BundleInput& input, const TrackChoice& choice, Bundle* bundle) {
  TrackOptions track_options = TrackOptions().ForCamera(input.set.surveys.front().survey.camera.floor);
  track_options.radius_m *= choice.radius_factor;
  track_options.min_views = 2;
  std::vector<KeypointTrack> tracks = FindTracks(input.set.frames, input.map_from_base, track_options);
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const auto& a, const auto& b) { return a.views.size() > b.views.size(); });
  std::vector<int> used(input.set.frames.size(), 0);
  for (const KeypointTrack& track : tracks) {
    const bool wanted = std::any_of(track.views.begin(), track.views.end(), [&](const auto& view) {
      return used[static_cast<std::size_t>(view.first)] < choice.per_frame;
    });
    if (!wanted) {
      continue;
    }
    ObservedTrack observed;
    observed.position_m = track.position_m;
    for (const auto& [frame, keypoint] : track.views) {
      const BuildFrame& from = input.set.frames[static_cast<std::size_t>(frame)];
      ++used[static_cast<std::size_t>(frame)];
      observed.observations.push_back(input.builders[static_cast<std::size_t>(from.survey)].Make(
          frame, from.features.keypoints[static_cast<std::size_t>(keypoint)].Position(), from.height_ratio));
    }
    bundle->tracks.push_back(std::move(observed));
  }
}

void AddAbsoluteConstraints(const BundleInput& input, double distance_sigma_m, Bundle* bundle) {
  const std::vector<BuildFrame>& frames = input.set.frames;
  std::map<std::pair<int, std::string>, int> by_name;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!input.map_from_base[i]) {
      continue;
    }
    by_name[{frames[i].survey, frames[i].info.filename}] = static_cast<int>(i);
    if (const std::optional<AbsolutePosePrior>& prior = frames[i].prior) {
      bundle->priors.push_back({static_cast<int>(i), prior->map_from_base, prior->covariance});
    }
  }
  for (std::size_t s = 0; s < input.set.surveys.size(); ++s) {
    const auto observe = [&](const std::string& file, const Eigen::Vector2d& raw_px) -> std::optional<Observation> {
      const auto frame = by_name.find({static_cast<int>(s), file});
      if (frame == by_name.end()) {
        return std::nullopt;
      }
      const BuildFrame& seen = frames[static_cast<std::size_t>(frame->second)];
      const double height_ratio = seen.height_ratio;
      const FloorCamera camera = input.builders[s].camera().AtHeight(height_ratio);
      return input.builders[s].Make(frame->second, FloorWhileMoving(camera, raw_px, seen.readout_motion), height_ratio);
    };
    for (const ControlPoint& point : input.set.surveys[s].survey.control_points) {
      if (const auto observation = observe(point.filename, point.raw_px)) {
        bundle->control_points.push_back(
            {*observation, point.point_in_map_m, point.sigma_m.value_or(ControlPointFactor().sigma_m)});
      }
    }
    for (const KnownDistance& distance : input.set.surveys[s].survey.known_distances) {
      const auto first = observe(distance.first_filename, distance.first_raw_px);
      const auto second = observe(distance.second_filename, distance.second_raw_px);
      if (first && second) {
        bundle->distances.push_back({*first, *second, distance.distance_m, distance_sigma_m});
      }
    }
  }
}

}  // namespace floorloc
