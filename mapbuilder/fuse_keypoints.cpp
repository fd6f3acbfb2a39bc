// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fuse_keypoints.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <unordered_map>

#include "core/vision/guided_matcher.h"
#include "mapbuilder/cell_key.h"
#include "mapbuilder/coverage.h"

namespace floorloc {
namespace {

// A map point in the making.
struct Track {
  Eigen::Vector2d position_sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d angle_sum = Eigen::Vector2d::Zero();  // of unit vectors
  double size_sum = 0.0;
  double response_sum = 0.0;
  int last_frame = -1;
  std::vector<std::pair<int, int>> views;  // frame, keypoint

  double count() const { return static_cast<double>(views.size()); }
  Eigen::Vector2d Position() const { return position_sum / count(); }
  double Angle() const { return std::atan2(angle_sum.y(), angle_sum.x()); }
};

class Fuser {
 public:
  Fuser(const std::vector<BuildFrame>& frames, const FusionOptions& options) : frames_(frames), options_(options) {}

  void AddFrame(int frame, const Pose2& map_from_base) {
    const Features& features = frames_[static_cast<std::size_t>(frame)].features;
    for (std::size_t i = 0; i < features.keypoints.size(); ++i) {
      const Keypoint& k = features.keypoints[i];
      const Eigen::Vector2d position = map_from_base * k.Position();
      const double angle = WrapAngle(map_from_base.yaw() + k.angle_rad);
      Track& track = FindOrCreate({frame, static_cast<int>(i)}, position, angle);
      track.position_sum += position;
      track.angle_sum += Eigen::Vector2d(std::cos(angle), std::sin(angle));
      track.size_sum += k.size_m;
      track.response_sum += k.response;
      track.last_frame = frame;
      track.views.emplace_back(frame, static_cast<int>(i));
    }
  }

  const std::vector<Track>& tracks() const { return tracks_; }

 private:
  // Share by which two views' descriptors differ, relative to what is allowed: below 1 they may be one point.
  double Difference(const std::pair<int, int>& a, const std::pair<int, int>& b) const {
    const cv::Mat da = frames_[static_cast<std::size_t>(a.first)].features.descriptors.row(a.second);
    const cv::Mat db = frames_[static_cast<std::size_t>(b.first)].features.descriptors.row(b.second);
    if (da.depth() == CV_8U) {
      return cv::norm(da, db, cv::NORM_HAMMING) / (8.0 * da.cols) / options_.max_binary_share;
    }
    return cv::norm(da, db, cv::NORM_L2) / (cv::norm(da, cv::NORM_L2) + 1e-9) / options_.max_float_share;
  }

  Track& FindOrCreate(const std::pair<int, int>& view, const Eigen::Vector2d& p, double angle) {
    const float size =
        frames_[static_cast<std::size_t>(view.first)].features.keypoints[static_cast<std::size_t>(view.second)].size_m;
    int best = -1;
    double best_difference = 1.0;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto cell = grid_.find(CellKey(p + options_.radius_m * Eigen::Vector2d(dx, dy), options_.radius_m));
        if (cell == grid_.end()) {
          continue;
        }
        for (const int t : cell->second) {
          const Track& track = tracks_[static_cast<std::size_t>(t)];
          const double track_size = track.size_sum / track.count();
          if (track.last_frame == view.first || (track.Position() - p).norm() > options_.radius_m ||
              std::abs(WrapAngle(track.Angle() - angle)) > options_.angle_rad || size > kMaxSizeRatio * track_size ||
              track_size > kMaxSizeRatio * size) {
            continue;
          }
          const double difference = Difference(view, track.views.front());
          if (difference < best_difference) {
            best_difference = difference;
            best = t;
          }
        }
      }
    }
    if (best < 0) {
      best = static_cast<int>(tracks_.size());
      tracks_.emplace_back();
      grid_[CellKey(p, options_.radius_m)].push_back(best);
    }
    return tracks_[static_cast<std::size_t>(best)];
  }

  const std::vector<BuildFrame>& frames_;
  const FusionOptions& options_;
  std::vector<Track> tracks_;
  std::unordered_map<std::int64_t, std::vector<int>> grid_;
};

cv::Mat MajorityDescriptor(const std::vector<cv::Mat>& rows) {
  cv::Mat majority = cv::Mat::zeros(1, rows.front().cols, CV_8U);
  for (int byte = 0; byte < majority.cols; ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      int ones = 0;
      for (const cv::Mat& row : rows) {
        ones += row.at<std::uint8_t>(0, byte) >> bit & 1;
      }
      // A tie is decided by the first view.
      const int twice = 2 * ones - static_cast<int>(rows.size());
      const bool set = twice > 0 || (twice == 0 && (rows.front().at<std::uint8_t>(0, byte) >> bit & 1) != 0);
      majority.at<std::uint8_t>(0, byte) |= static_cast<std::uint8_t>(set ? 1 << bit : 0);
    }
  }
  return majority;
}

cv::Mat FusedDescriptor(const std::vector<BuildFrame>& frames, const Track& track) {
  std::vector<cv::Mat> rows;
  for (const auto& [frame, keypoint] : track.views) {
    rows.push_back(frames[static_cast<std::size_t>(frame)].features.descriptors.row(keypoint));
  }
  if (rows.front().depth() == CV_8U) {
    return MajorityDescriptor(rows);
  }
  cv::Mat mean = cv::Mat::zeros(1, rows.front().cols, CV_32F);
  for (const cv::Mat& row : rows) {
    mean += row;
  }
  return mean / static_cast<double>(rows.size());
}

int NewestSurvey(const std::vector<BuildFrame>& frames, const Track& track) {
  int newest = 0;
  for (const auto& [frame, keypoint] : track.views) {
    newest = std::max(newest, frames[static_cast<std::size_t>(frame)].survey);
  }
  return newest;
}

// The best tracks of every cell of the budget grid: most observations first, then the strongest.
std::vector<int> ChooseWithinBudget(const std::vector<Track>& tracks, std::vector<int> candidates,
                                    const FusionOptions& options) {
  const double cell_m = options.budget_cell_m;
  const auto budget = static_cast<std::size_t>(std::max(1.0, options.max_per_m2 * cell_m * cell_m));
  std::stable_sort(candidates.begin(), candidates.end(), [&](int a, int b) {
    const Track& x = tracks[static_cast<std::size_t>(a)];
    const Track& y = tracks[static_cast<std::size_t>(b)];
    return x.views.size() != y.views.size() ? x.views.size() > y.views.size()
                                            : x.response_sum * y.count() > y.response_sum * x.count();
  });
  std::unordered_map<std::int64_t, std::size_t> used;
  std::vector<int> chosen;
  for (const int t : candidates) {
    const Eigen::Vector2d p = tracks[static_cast<std::size_t>(t)].Position();
    if (used[CellKey(p, cell_m)]++ < budget) {
      chosen.push_back(t);
    }
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

FusionOptions FusionOptions::ForCamera(const FloorPlane& floor, int keypoints_per_frame) const {
  constexpr double kReferenceResolutionM = 7e-4;
  constexpr double kReferenceViewM2 = 0.129;
  constexpr double kReferenceKeypoints = 700.0;
  const double view_m2 = floor.roi.width_m() * floor.roi.height_m();
  FusionOptions adapted = *this;
  adapted.radius_m *= floor.resolution_m / kReferenceResolutionM;
  adapted.max_per_m2 *= kReferenceViewM2 / view_m2 * (keypoints_per_frame / kReferenceKeypoints);
  adapted.budget_cell_m *= std::sqrt(view_m2 / kReferenceViewM2);
  return adapted;
}

MapKeypoints FuseKeypoints(const std::vector<BuildFrame>& frames,
                           const std::vector<std::optional<Pose2>>& map_from_base,
                           const std::vector<RectM>& floor_in_base, const FusionOptions& options) {
  Fuser fuser(frames, options);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (map_from_base[i]) {
      fuser.AddFrame(static_cast<int>(i), *map_from_base[i]);
    }
  }
  const CoverageGrid coverage(map_from_base, floor_in_base);
  const std::vector<Track>& tracks = fuser.tracks();
  std::vector<int> candidates;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (tracks[t].views.size() > 1 || coverage.CountAt(tracks[t].Position()) < options.min_coverage) {
      candidates.push_back(static_cast<int>(t));
    }
  }
  MapKeypoints map;
  for (const int t : ChooseWithinBudget(tracks, std::move(candidates), options)) {
    const Track& track = tracks[static_cast<std::size_t>(t)];
    const Eigen::Vector2d p = track.Position();
    map.keypoints.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(track.Angle()),
                             static_cast<float>(track.size_sum / track.count()),
                             static_cast<float>(track.response_sum / track.count())});
    // How alike the map's keypoints are is not measured here.
    map.distinctiveness.push_back(255);
    map.last_survey.push_back(static_cast<std::uint16_t>(NewestSurvey(frames, track)));
    map.observations.push_back(static_cast<std::uint16_t>(std::min<std::size_t>(track.views.size(), 65535)));
    map.descriptors.push_back(FusedDescriptor(frames, track));
  }
  return map;
}

}  // namespace floorloc
