// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/keypoint_tracks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/geometry/option_check.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/coverage/cell_key.h"
#include "mapbuilder/keypoints/descriptor_rows.h"

namespace floorloc {
namespace {

constexpr int kNone = -1;

// A keypoint in the map frame.
struct View {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double angle = 0.0;
  double size = 0.0;
};

// A track under construction. Its angle and size are those of its first view.
struct Growing {
  Eigen::Vector2d position_sum = Eigen::Vector2d::Zero();
  float weight = 0.0F;
  float angle = 0.0F;
  float size = 0.0F;
  int first_frame = kNone;  // frame of the descriptor; kNone: a seed
  int first_keypoint = 0;
  int last_frame = kNone;
  int next_in_cell = kNone;

  Eigen::Vector2d Position() const { return position_sum / weight; }
};

// Hash grid of tracks by the position of their first view, with chaining. Hash collisions are harmless, since positions
// are compared anyway.
class TrackGrid {
 public:
  TrackGrid(std::size_t expected, double reach_m)
      : cell_m_(2.0 * reach_m), heads_(std::bit_ceil(std::max<std::size_t>(expected, 16)), kNone) {}

  void Insert(int track, const Eigen::Vector2d& place, std::vector<Growing>* tracks) {
    int& head = heads_[Slot(place / cell_m_)];
    (*tracks)[static_cast<std::size_t>(track)].next_in_cell = head;
    head = track;
  }

  // Calls visit(track) for all tracks whose first view is within reach of the position, and for some others.
  template <typename Visit>
  void VisitNear(const Eigen::Vector2d& place, const std::vector<Growing>& tracks, const Visit& visit) const {
    for (const double dx : {-0.5, 0.5}) {
      for (const double dy : {-0.5, 0.5}) {
        int t = heads_[Slot(place / cell_m_ + Eigen::Vector2d(dx, dy))];
        for (; t != kNone; t = tracks[static_cast<std::size_t>(t)].next_in_cell) {
          visit(t);
        }
      }
    }
  }

 private:
  std::size_t Slot(const Eigen::Vector2d& cell) const {
    constexpr std::uint64_t kMix = 0x9E3779B97F4A7C15ULL;
    const std::uint64_t key = static_cast<std::uint64_t>(CellKey(cell, 1.0)) * kMix;
    return static_cast<std::size_t>(key >> 32 ^ key) & (heads_.size() - 1);
  }

  double cell_m_;
  std::vector<int> heads_;
};

std::size_t CountViews(const std::vector<BuildFrame>& frames, const std::vector<std::optional<Pose2>>& map_from_base) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    count += map_from_base[i] ? frames[i].features.keypoints.size() : 0;
  }
  return count;
}

class TrackFinder {
 public:
  TrackFinder(const std::vector<BuildFrame>& frames, const TrackOptions& options, std::size_t views)
      : frames_(frames),
        options_(options),
        grid_(views / 2, kDriftedRadius * options.radius_m),
        track_of_(frames.size()) {
    rows_.reserve(frames.size());
    for (const BuildFrame& frame : frames) {
      rows_.emplace_back(frame.features.descriptors);
    }
  }

  void AddSeeds(const MapKeypoints& seeds) {
    seed_rows_ = DescriptorRows(seeds.descriptors);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      const Keypoint& k = seeds.keypoints[i];
      Start({k.Position(), k.angle_rad, k.size_m}, kNone, static_cast<int>(i));
      Growing& track = tracks_.back();
      const auto weight = static_cast<float>(std::max<int>(1, seeds.observations[i]));
      track.position_sum *= weight;
      track.weight = weight;
    }
    seeds_ = seeds.size();
  }

  void AddFrame(int frame, const Pose2& map_from_base) {
    const Features& features = frames_[static_cast<std::size_t>(frame)].features;
    std::vector<View> views;
    std::vector<Proposal> proposals;
    for (const Keypoint& k : features.keypoints) {
      views.push_back({map_from_base * k.Position(), WrapAngle(map_from_base.yaw() + k.angle_rad), k.size_m});
      proposals.push_back(FindBest(views.back(), frame, static_cast<int>(proposals.size())));
    }
    std::stable_sort(proposals.begin(), proposals.end(),
                     [](const Proposal& a, const Proposal& b) { return a.difference < b.difference; });
    track_of_[static_cast<std::size_t>(frame)].resize(views.size());
    std::vector<int> starting;
    for (Proposal& p : proposals) {
      const View& view = views[static_cast<std::size_t>(p.keypoint)];
      if (p.track != kNone && tracks_[static_cast<std::size_t>(p.track)].last_frame == frame) {
        p = FindBest(view, frame, p.keypoint);  // lost it to a more similar keypoint of the frame
      }
      if (p.track == kNone) {
        starting.push_back(p.keypoint);
      } else {
        Join(view, frame, p);
      }
    }
    for (const int keypoint : starting) {
      Start(views[static_cast<std::size_t>(keypoint)], frame, keypoint);
    }
  }

  std::vector<KeypointTrack> Finish() const {
    std::vector<int> counts(tracks_.size(), 0);
    VisitViews([&](int, int, int track) { ++counts[static_cast<std::size_t>(track)]; });
    std::vector<int> place(tracks_.size(), kNone);
    std::vector<KeypointTrack> result;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      if (t < seeds_ || counts[t] >= options_.min_views) {
        place[t] = static_cast<int>(result.size());
        result.push_back({tracks_[t].Position(), {}});
        result.back().views.reserve(static_cast<std::size_t>(counts[t]));
      }
    }
    VisitViews([&](int frame, int keypoint, int track) {
      const int p = place[static_cast<std::size_t>(track)];
      if (p != kNone) {
        result[static_cast<std::size_t>(p)].views.emplace_back(frame, keypoint);
      }
    });
    return result;
  }

 private:
  // Search radius factor: a track's mean may have drifted away from its first view, by which it is indexed.
  static constexpr double kDriftedRadius = 1.5;

  struct Proposal {
    int keypoint = 0;
    int track = kNone;
    double difference = 1.0;  // as a share of the allowed one
  };

  bool MayBeSame(const Growing& track, const View& view, int frame) const {
    return track.last_frame != frame && (track.Position() - view.position).norm() <= options_.radius_m &&
           std::abs(WrapAngle(track.angle - view.angle)) <= options_.angle_rad &&
           view.size <= kMaxSizeRatio * track.size && track.size <= kMaxSizeRatio * view.size;
  }

  Proposal FindBest(const View& view, int frame, int keypoint) const {
    Proposal best{keypoint, kNone, 1.0};
    const bool binary = frames_[static_cast<std::size_t>(frame)].features.descriptors.depth() == CV_8U;
    const double allowed = binary ? options_.max_binary_share : options_.max_float_share;
    grid_.VisitNear(view.position, tracks_, [&](int t) {
      const Growing& track = tracks_[static_cast<std::size_t>(t)];
      if (!MayBeSame(track, view, frame)) {
        return;
      }
      const DescriptorRows& rows =
          track.first_frame == kNone ? seed_rows_ : rows_[static_cast<std::size_t>(track.first_frame)];
      const double difference =
          DescriptorRows::Difference(rows_[static_cast<std::size_t>(frame)], keypoint, rows, track.first_keypoint) /
          allowed;
      if (difference < best.difference || (difference == best.difference && t < best.track)) {
        best = {keypoint, t, difference};
      }
    });
    return best;
  }

  void Join(const View& view, int frame, const Proposal& p) {
    Growing& track = tracks_[static_cast<std::size_t>(p.track)];
    track.position_sum += view.position;
    track.weight += 1.0F;
    track.last_frame = frame;
    track_of_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(p.keypoint)] = p.track;
  }

  void Start(const View& view, int frame, int keypoint) {
    const int track = static_cast<int>(tracks_.size());
    tracks_.push_back({view.position, 1.0F, static_cast<float>(view.angle), static_cast<float>(view.size), frame,
                       keypoint, frame, kNone});
    grid_.Insert(track, view.position, &tracks_);
    if (frame != kNone) {
      track_of_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(keypoint)] = track;
    }
  }

  template <typename Visit>
  void VisitViews(const Visit& visit) const {
    for (std::size_t f = 0; f < track_of_.size(); ++f) {
      for (std::size_t k = 0; k < track_of_[f].size(); ++k) {
        visit(static_cast<int>(f), static_cast<int>(k), track_of_[f][k]);
      }
    }
  }

  const std::vector<BuildFrame>& frames_;
  const TrackOptions& options_;
  std::vector<DescriptorRows> rows_;  // of each frame
  DescriptorRows seed_rows_;
  std::size_t seeds_ = 0;
  std::vector<Growing> tracks_;
  TrackGrid grid_;
  std::vector<std::vector<int>> track_of_;  // of each frame's keypoints
};

}  // namespace

void TrackOptions::Check() const {
  RequireOption(radius_m > 0.0, "radius_m must be positive");
  RequireOption(angle_rad > 0.0, "angle_rad must be positive");
  RequireOption(max_binary_share > 0.0 && max_binary_share <= 1.0, "max_binary_share must be above 0 and at most 1");
  RequireOption(max_float_share > 0.0, "max_float_share must be positive");
  RequireOption(min_views >= 1, "min_views must be at least 1");
}

TrackOptions TrackOptions::ForCamera(const FloorPlane& floor) const {
  constexpr double kReferenceResolutionM = 7e-4;
  TrackOptions adapted = *this;
  adapted.radius_m *= floor.resolution_m / kReferenceResolutionM;
  return adapted;
}

std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options) {
  return FindTracks(frames, map_from_base, options, MapKeypoints());
}

std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options, const MapKeypoints& seeds) {
  options.Check();
  TrackFinder finder(frames, options, CountViews(frames, map_from_base) + seeds.size());
  finder.AddSeeds(seeds);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (map_from_base[i]) {
      finder.AddFrame(static_cast<int>(i), *map_from_base[i]);
    }
  }
  return finder.Finish();
}

}  // namespace floorloc
