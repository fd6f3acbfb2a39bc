// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/fuse_keypoints.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/keypoints/distinctiveness.h"
#include "mapbuilder/keypoints/fuse_track.h"
#include "mapbuilder/keypoints/keypoint_usefulness.h"

namespace floorloc {
namespace {

constexpr int kNone = -1;

// A track that may become a map point.
struct Candidate {
  KeypointTrack track;
  int base_index = kNone;     // index of the same point in the base map
  int visible = 0;            // new frames that cover it
  int base_observations = 0;  // in the base map
  int base_visible = 0;
  float response = 0.0F;

  bool IsUnobserved() const { return base_index != kNone && visible == 0; }
  int views() const { return static_cast<int>(track.views.size()); }
};

// Floor on which keypoints were detected, per frame: extractors skip the image border and the border of the mask.
std::vector<RectM> DetectableFloor(const std::vector<BuildFrame>& frames) {
  std::vector<Eigen::AlignedBox2d> of_survey;
  for (const BuildFrame& frame : frames) {
    const auto survey = static_cast<std::size_t>(frame.survey);
    of_survey.resize(std::max(of_survey.size(), survey + 1));
    Eigen::AlignedBox2d& box = of_survey[survey];
    for (const Keypoint& k : frame.features.keypoints) {
      box.extend(k.Position());
    }
  }
  std::vector<RectM> floors;
  for (const BuildFrame& frame : frames) {
    const Eigen::AlignedBox2d& box = of_survey[static_cast<std::size_t>(frame.survey)];
    floors.push_back(box.isEmpty() ? RectM() : RectM{box.min().x(), box.max().x(), box.min().y(), box.max().y()});
  }
  return floors;
}

// Of the base map, or near the frames.
Eigen::Vector2d OriginOf(const KeypointFusionInput& input) {
  if (input.base_map != nullptr) {
    return input.base_map->origin_m;
  }
  Eigen::AlignedBox2d box;
  for (const std::optional<Pose2>& pose : input.map_from_base) {
    if (pose) {
      box.extend(pose->translation());
    }
  }
  return box.isEmpty() ? Eigen::Vector2d::Zero().eval()
                       : KeypointOrigin({box.min().x(), box.max().x(), box.min().y(), box.max().y()});
}

std::vector<std::optional<Pose2>> FromOrigin(std::vector<std::optional<Pose2>> map_from_base,
                                             const Eigen::Vector2d& origin_m) {
  const Pose2 origin_from_map(-origin_m.x(), -origin_m.y(), 0.0);
  for (std::optional<Pose2>& pose : map_from_base) {
    if (pose) {
      pose = origin_from_map * *pose;
    }
  }
  return map_from_base;
}

float MeanResponse(const KeypointTrack& track, const std::vector<BuildFrame>& frames) {
  float sum = 0.0F;
  for (const auto& [frame, keypoint] : track.views) {
    sum += frames[static_cast<std::size_t>(frame)].features.keypoints[static_cast<std::size_t>(keypoint)].response;
  }
  return sum / static_cast<float>(track.views.size());
}

std::vector<Candidate> FindCandidates(const KeypointFusionInput& input, const CoverageGrid& detectable,
                                      const TrackOptions& options) {
  const MapKeypoints none;
  const MapKeypoints& base_map = input.base_map != nullptr ? *input.base_map : none;
  std::vector<KeypointTrack> tracks = FindTracks(input.frames, input.map_from_base, options, base_map);
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    Candidate c;
    c.visible = std::max(detectable.CountAt(tracks[i].position_m), static_cast<int>(tracks[i].views.size()));
    if (i < base_map.size()) {
      c.base_index = static_cast<int>(i);
      c.base_observations = std::max<int>(1, base_map.observations[i]);
      c.response = base_map.keypoints[i].response;
      if (input.base_coverage != nullptr) {
        c.base_visible = std::max(c.base_observations, input.base_coverage->CountAt(base_map.PositionInMap(i)));
      }
    } else {
      c.response = MeanResponse(tracks[i], input.frames);
    }
    c.track = std::move(tracks[i]);
    candidates.push_back(std::move(c));
  }
  return candidates;
}

// Repeat rates, estimated from the points that the new frames observed.
RepeatRates EstimateRepeatRates(const std::vector<Candidate>& candidates) {
  std::vector<PointHistory> histories;
  for (const Candidate& c : candidates) {
    if (c.views() > 0) {
      histories.push_back({c.views(), c.visible, c.response, 255});
    }
  }
  return RepeatRates(histories);
}

bool HasDisappeared(const Candidate& c, const RepeatRates& rates, const KeypointFusionOptions& options) {
  if (c.base_index == kNone || c.views() > 0 || c.visible < options.min_frames_gone) {
    return false;
  }
  double rate = rates.OfResponse(c.response);
  if (c.base_visible > 0) {
    rate = std::min(rate, rates.Of({c.base_observations, c.base_visible, c.response, 255}));
  }
  return std::pow(1.0 - rate, c.visible) < options.gone_probability;
}

// History in base map and new frames; an unknown number of covering base frames is estimated from the repeat rate.
PointHistory HistoryOf(const Candidate& c, const RepeatRates& rates) {
  int base_visible = c.base_visible;
  if (c.base_index != kNone && base_visible == 0) {
    base_visible = static_cast<int>(std::lround(c.base_observations / std::max(rates.OfResponse(c.response), 0.01)));
  }
  return {c.base_observations + c.views(), base_visible + c.visible, c.response, 255};
}

std::uint16_t ClampToUint16(int count) { return static_cast<std::uint16_t>(std::min(count, 65535)); }

std::uint16_t LastSurvey(const Candidate& c, const KeypointFusionInput& input) {
  if (c.views() == 0) {
    return input.base_map->last_survey[static_cast<std::size_t>(c.base_index)];
  }
  int newest = 0;
  for (const auto& [frame, keypoint] : c.track.views) {
    newest = std::max(newest, input.frames[static_cast<std::size_t>(frame)].survey);
  }
  return ClampToUint16(input.first_survey + newest);
}

// A matrix of the descriptors' type with one uninitialised row per point.
cv::Mat MakeDescriptors(const KeypointFusionInput& input, std::size_t rows) {
  cv::Mat like = input.base_map != nullptr ? input.base_map->descriptors : cv::Mat();
  for (std::size_t i = 0; i < input.frames.size() && like.empty(); ++i) {
    like = input.frames[i].features.descriptors;
  }
  return cv::Mat(static_cast<int>(rows), like.cols, like.type());
}

// Distinctiveness is not filled in.
MapKeypoints FusePoints(const KeypointFusionInput& input, const std::vector<Candidate>& candidates,
                        const KeypointFusionOptions& options) {
  constexpr std::size_t kChunk = 4096;
  MapKeypoints map;
  map.keypoints.resize(candidates.size());
  map.observations.resize(candidates.size());
  map.last_survey.resize(candidates.size());
  map.descriptors = MakeDescriptors(input, candidates.size());
  const double huber_m = 0.25 * options.tracks.radius_m;
  ParallelFor(static_cast<int>((candidates.size() + kChunk - 1) / kChunk), options.run.threads, [&](int chunk) {
    const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
    TrackFuser fuser(input.frames, input.map_from_base, map.descriptors, huber_m);
    for (std::size_t i = begin; i < std::min(candidates.size(), begin + kChunk); ++i) {
      const Candidate& c = candidates[i];
      const int row = static_cast<int>(i);
      FusedPoint point;
      if (c.base_index == kNone) {
        point = fuser.Fuse(c.track, &map.descriptors, row);
      } else if (c.views() > 0) {
        point = fuser.Update(*input.base_map, c.base_index, c.track, &map.descriptors, row);
      } else {
        point = {input.base_map->keypoints[static_cast<std::size_t>(c.base_index)], c.base_observations};
        input.base_map->descriptors.row(c.base_index).copyTo(map.descriptors.row(row));
      }
      map.keypoints[i] = point.keypoint;
      map.observations[i] = ClampToUint16(point.observations);
      map.last_survey[i] = LastSurvey(c, input);
    }
  });
  return map;
}

// The useful points within the budget among those that the new frames cover, and all points outside their view.
// Ascending.
std::vector<int> SelectUseful(const MapKeypoints& map, const std::vector<Candidate>& candidates,
                              const RepeatRates& rates, const CoverageGrid& coverage, const PruningOptions& options) {
  std::vector<int> chosen;
  std::vector<int> in_view;
  std::vector<Eigen::Vector2d> positions;
  std::vector<PointHistory> histories;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].IsUnobserved()) {
      chosen.push_back(static_cast<int>(i));
      continue;
    }
    in_view.push_back(static_cast<int>(i));
    positions.push_back(map.keypoints[i].Position());
    histories.push_back(HistoryOf(candidates[i], rates));
    histories.back().distinctiveness = map.distinctiveness[i];
  }
  IgnoreDuplicatesWhereCommon(positions, options.cell_m, &histories);
  for (const int i : ChooseEvenly(positions, Usefulness(histories, rates), coverage, options)) {
    chosen.push_back(in_view[static_cast<std::size_t>(i)]);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

MapKeypoints Select(const MapKeypoints& map, const std::vector<int>& chosen) {
  MapKeypoints selected;
  selected.descriptors.create(static_cast<int>(chosen.size()), map.descriptors.cols, map.descriptors.type());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto from = static_cast<std::size_t>(chosen[i]);
    selected.keypoints.push_back(map.keypoints[from]);
    selected.observations.push_back(map.observations[from]);
    selected.distinctiveness.push_back(map.distinctiveness[from]);
    selected.last_survey.push_back(map.last_survey[from]);
    map.descriptors.row(chosen[i]).copyTo(selected.descriptors.row(static_cast<int>(i)));
  }
  return selected;
}

}  // namespace

KeypointFusionOptions KeypointFusionOptions::ForCamera(const FloorPlane& floor, int keypoints_per_frame) const {
  KeypointFusionOptions adapted = *this;
  adapted.tracks = tracks.ForCamera(floor);
  adapted.pruning = pruning.ForCamera(floor, keypoints_per_frame);
  return adapted;
}

void KeypointFusionOptions::Check() const {
  tracks.Check();
  pruning.Check();
  RequireOption(min_coverage >= 1, "min_coverage must be at least 1");
  RequireOption(min_frames_gone >= 1, "min_frames_gone must be at least 1");
  RequireOption(gone_probability > 0.0 && gone_probability < 1.0, "gone_probability must be between 0 and 1");
  run.Check();
}

MapKeypoints FuseKeypoints(const KeypointFusionInput& in_map, const KeypointFusionOptions& options) {
  options.Check();
  // Map points are float32: all positions are counted from an origin near them.
  const Eigen::Vector2d origin_m = OriginOf(in_map);
  const std::vector<std::optional<Pose2>> poses = FromOrigin(in_map.map_from_base, origin_m);
  const KeypointFusionInput input{
      in_map.frames, poses, in_map.floor_in_base, in_map.base_map, in_map.base_coverage, in_map.first_survey};
  const CoverageGrid coverage(input.map_from_base, input.floor_in_base);
  const CoverageGrid detectable(input.map_from_base, DetectableFloor(input.frames));
  std::vector<Candidate> candidates = FindCandidates(input, detectable, options.tracks);
  const RepeatRates rates = EstimateRepeatRates(candidates);
  std::erase_if(candidates, [&](const Candidate& c) {
    const bool unconfirmed = c.base_index == kNone && c.views() == 1;
    return (unconfirmed && coverage.CountAt(c.track.position_m) >= options.min_coverage) ||
           HasDisappeared(c, rates, options);
  });
  MapKeypoints map = FusePoints(input, candidates, options);
  map.distinctiveness =
      MeasureDistinctiveness(map.keypoints, map.descriptors, {.run = options.run, .seed = options.seed});
  MapKeypoints selected = Select(map, SelectUseful(map, candidates, rates, coverage, options.pruning));
  selected.origin_m = origin_m;
  return selected;
}

}  // namespace floorloc
