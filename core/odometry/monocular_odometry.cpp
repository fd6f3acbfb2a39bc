// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/monocular_odometry.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/odometry/two_view.h"

namespace floorloc {
namespace {

// Least number of landmarks for a scale, and for a pose.
constexpr std::size_t kMinScaleLandmarks = 8;
constexpr std::size_t kMinPoseLandmarks = 20;

// Least angle between rays for a triangulation: below it the depth is noise.
constexpr double kMinAngleRad = 0.01;

// External positions that differ by less do not determine a length.
constexpr double kMinLengthM = 1e-3;

// A tracked point.
struct TrackedPoint {
  Eigen::Vector2d in_keyframe = Eigen::Vector2d::Zero();  // on the plane z = 1
  std::optional<double> depth;                            // z in the keyframe, in units of the world
};

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Motion of the camera since the keyframe, measured by one frame.
struct MeasuredMotion {
  MonocularStatus status = MonocularStatus::kLost;
  Eigen::Isometry3d camera_from_keyframe = Eigen::Isometry3d::Identity();
  std::vector<bool> inliers;  // per track; empty: all
  bool has_length = true;     // false: the length of the translation is assumed
};

}  // namespace

const char* ToString(MonocularStatus status) {
  switch (status) {
    case MonocularStatus::kFirstFrame:
      return "first_frame";
    case MonocularStatus::kTracked:
      return "tracked";
    case MonocularStatus::kRotated:
      return "rotated";
    case MonocularStatus::kLost:
      return "lost";
  }
  return "unknown";
}

void MonocularOdometryOptions::Check() const {
  tracker.Check();
  RequireOption(noise_px > 0.0 && noise_px <= 20.0, "noise_px must be above 0 and at most 20");
  RequireOption(min_parallax_px > 0.0, "min_parallax_px must be positive");
  RequireOption(keyframe_parallax_px > min_parallax_px, "keyframe_parallax_px must be above min_parallax_px");
  RequireOption(min_points >= 10, "min_points must be at least 10");
  RequireOption(min_inlier_share > 0.0 && min_inlier_share <= 1.0, "min_inlier_share must be above 0 and at most 1");
}

struct MonocularOdometry::State {
  State(const CameraModel& c, const MonocularOdometryOptions& o)
      : camera(c), options(o), tracker(o.tracker), focal_px(0.5 * (c.fx + c.fy)) {}

  CameraModel camera;
  MonocularOdometryOptions options;
  PointTracker tracker;
  double focal_px;
  std::vector<TrackedPoint> tracks;     // one per point of the tracker
  std::size_t initial_track_count = 0;  // points at the keyframe
  Eigen::Isometry3d world_from_keyframe = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d camera_from_keyframe = Eigen::Isometry3d::Identity();  // of the newest frame
  std::optional<Eigen::Vector3d> keyframe_position_m;
  std::optional<std::int64_t> newest_ns;
  double last_length = 1.0;  // translation between the last two keyframes; the unit of length, at first
  bool scaled = false;       // a length is known
  int scale_breaks = 0;

  Eigen::Vector2d OnPlane(const cv::Point2f& raw) const {
    const Eigen::Vector2d px = camera.Undistort({static_cast<double>(raw.x), static_cast<double>(raw.y)});
    return {(px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy};
  }

  std::vector<PointPair> Pairs() const {
    std::vector<PointPair> pairs;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      pairs.push_back({tracks[i].in_keyframe, OnPlane(tracker.points()[i])});
    }
    return pairs;
  }

  void Advance(const cv::Mat& raw) {
    const std::vector<bool> found = tracker.Advance(raw);
    std::vector<TrackedPoint> kept;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      if (found[i]) {
        kept.push_back(tracks[i]);
      }
    }
    tracks = std::move(kept);
  }

  std::vector<LandmarkObservation> Landmarks(const std::vector<PointPair>& pairs) const {
    std::vector<LandmarkObservation> landmarks;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      if (tracks[i].depth) {
        landmarks.push_back({*tracks[i].depth * pairs[i].first.homogeneous(), pairs[i].second});
      }
    }
    return landmarks;
  }

  // Length of the translation since the keyframe by external positions or by landmarks of the keyframe; empty without
  // either.
  std::optional<double> TranslationLength(const TwoViewMotion& motion, const std::vector<PointPair>& pairs,
                                          const std::optional<Eigen::Vector3d>& position_m) const {
    if (position_m && keyframe_position_m) {
      return (*position_m - *keyframe_position_m).norm();
    }
    Eigen::Isometry3d unit = Eigen::Isometry3d::Identity();
    unit.linear() = motion.second_from_first;
    unit.translation() = motion.direction;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto depth =
          motion.inliers[i] && tracks[i].depth ? TriangulateDepth(pairs[i], unit, kMinAngleRad) : std::nullopt;
      if (depth) {
        ratios.push_back(*tracks[i].depth / *depth);
      }
    }
    if (ratios.size() >= kMinScaleLandmarks) {
      return Median(std::move(ratios));
    }
    return std::nullopt;
  }

  // With little parallax the essential matrix is ill-conditioned, but landmarks may still determine the pose.
  MeasuredMotion MeasureWithSmallParallax(const std::vector<PointPair>& pairs, const RotationFit& rotation) const {
    MeasuredMotion measured;
    const std::vector<LandmarkObservation> landmarks = Landmarks(pairs);
    if (landmarks.size() >= kMinPoseLandmarks) {
      const auto pose =
          RefinePoseByLandmarks(landmarks, camera_from_keyframe, options.noise_px / focal_px, options.min_inlier_share);
      if (pose) {
        measured.status = MonocularStatus::kTracked;
        measured.camera_from_keyframe = *pose;
        return measured;
      }
    }
    measured.status = MonocularStatus::kRotated;
    // Only the rotation is known; the position is kept.
    const Eigen::Vector3d center = camera_from_keyframe.inverse().translation();
    measured.camera_from_keyframe.linear() = rotation.second_from_first;
    measured.camera_from_keyframe.translation() = -(rotation.second_from_first * center);
    return measured;
  }

  MeasuredMotion MeasureWithLargeParallax(const std::vector<PointPair>& pairs,
                                          const std::optional<Eigen::Vector3d>& position_m) const {
    MeasuredMotion measured;
    const auto motion = EstimateMotion(pairs, options.noise_px / focal_px);
    if (!motion || motion->inlier_count < options.min_inlier_share * static_cast<double>(pairs.size())) {
      return measured;
    }
    const std::optional<double> length = TranslationLength(*motion, pairs, position_m);
    measured.status = MonocularStatus::kTracked;
    measured.has_length = length.has_value();
    measured.inliers = motion->inliers;
    measured.camera_from_keyframe.linear() = motion->second_from_first;
    measured.camera_from_keyframe.translation() = length.value_or(last_length) * motion->direction;
    return measured;
  }

  MonocularOdometryResult StartKeyframe(const std::optional<Eigen::Vector3d>& position_m, MonocularStatus status) {
    world_from_keyframe = world_from_keyframe * camera_from_keyframe.inverse();
    camera_from_keyframe = Eigen::Isometry3d::Identity();
    tracks.clear();
    AddTracks(position_m);
    MonocularOdometryResult result = ResultOf(status);
    result.new_keyframe = true;
    return result;
  }

  // Starts a track for each point of the newest frame.
  void AddTracks(const std::optional<Eigen::Vector3d>& position_m) {
    tracker.Detect();
    for (std::size_t i = tracks.size(); i < tracker.points().size(); ++i) {
      tracks.push_back({OnPlane(tracker.points()[i]), std::nullopt});
    }
    initial_track_count = tracks.size();
    keyframe_position_m = position_m;
  }

  // Makes the newest frame the keyframe; points visible in both keyframes get a depth in it.
  void MakeKeyframe(const MeasuredMotion& measured, const std::vector<PointPair>& pairs,
                    const std::optional<Eigen::Vector3d>& position_m) {
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      TrackedPoint& track = tracks[i];
      std::optional<double> depth = TriangulateDepth(pairs[i], camera_from_keyframe, kMinAngleRad);
      depth = depth ? depth : track.depth;
      track.in_keyframe = pairs[i].second;
      const bool agrees = measured.inliers.empty() || measured.inliers[i];
      track.depth = std::nullopt;
      if (depth && agrees) {
        const double z = (camera_from_keyframe * (*depth * pairs[i].first.homogeneous())).z();
        track.depth = z > 0.0 ? std::optional<double>(z) : std::nullopt;
      }
    }
    last_length = camera_from_keyframe.translation().norm();
    scale_breaks += scaled && !measured.has_length ? 1 : 0;
    scaled = true;
    world_from_keyframe = world_from_keyframe * camera_from_keyframe.inverse();
    camera_from_keyframe = Eigen::Isometry3d::Identity();
    AddTracks(position_m);
  }

  // True when external positions say that the camera has not moved.
  bool IsStationary(const std::optional<Eigen::Vector3d>& position_m) const {
    return position_m && keyframe_position_m && (*position_m - *keyframe_position_m).norm() < kMinLengthM;
  }

  MonocularOdometryResult ResultOf(MonocularStatus status) const {
    MonocularOdometryResult result;
    result.status = status;
    result.world_from_camera = world_from_keyframe * camera_from_keyframe.inverse();
    result.tracked = static_cast<int>(tracks.size());
    result.inliers = result.tracked;
    result.scale_breaks = scale_breaks;
    return result;
  }

  MonocularOdometryResult TrackFrame(const std::optional<Eigen::Vector3d>& position_m) {
    const std::vector<PointPair> pairs = Pairs();
    const RotationFit rotation = FitRotation(pairs);
    const double parallax_px = rotation.parallax_rad * focal_px;
    const bool far = parallax_px >= options.keyframe_parallax_px || 2 * tracks.size() < initial_track_count;
    MeasuredMotion measured = parallax_px < options.min_parallax_px || IsStationary(position_m)
                                  ? MeasureWithSmallParallax(pairs, rotation)
                                  : MeasureWithLargeParallax(pairs, position_m);
    if (measured.status == MonocularStatus::kTracked && !measured.has_length && !far) {
      measured = MeasureWithSmallParallax(pairs, rotation);
    }
    if (measured.status == MonocularStatus::kLost) {
      return StartKeyframe(position_m, MonocularStatus::kLost);
    }
    camera_from_keyframe = measured.camera_from_keyframe;
    MonocularOdometryResult result = ResultOf(measured.status);
    result.parallax_px = parallax_px;
    if (!measured.inliers.empty()) {
      result.inliers = static_cast<int>(std::count(measured.inliers.begin(), measured.inliers.end(), true));
    }
    result.new_keyframe = far && measured.status == MonocularStatus::kTracked;
    if (result.new_keyframe) {
      MakeKeyframe(measured, pairs, position_m);
      result.scale_breaks = scale_breaks;
    }
    return result;
  }
};

MonocularOdometry::MonocularOdometry(const CameraModel& camera, const MonocularOdometryOptions& options) {
  camera.Check();
  options.Check();
  state_ = std::make_unique<State>(camera, options);
}

MonocularOdometry::~MonocularOdometry() = default;
MonocularOdometry::MonocularOdometry(MonocularOdometry&&) noexcept = default;
MonocularOdometry& MonocularOdometry::operator=(MonocularOdometry&&) noexcept = default;

MonocularOdometryResult MonocularOdometry::Track(std::int64_t stamp_ns, const cv::Mat& raw,
                                                 const std::optional<Eigen::Vector3d>& position_m) {
  State& s = *state_;
  if (s.newest_ns && stamp_ns <= *s.newest_ns) {
    throw std::invalid_argument("the time stamp " + std::to_string(stamp_ns) +
                                " ns is not after the previous frame's, " + std::to_string(*s.newest_ns) +
                                " ns; give frames in order of time");
  }
  if (raw.type() != CV_8UC1 || raw.cols != s.camera.width_px || raw.rows != s.camera.height_px) {
    throw std::invalid_argument("the image must be grey (8 bit) and of the camera's size, " +
                                std::to_string(s.camera.width_px) + "x" + std::to_string(s.camera.height_px));
  }
  const bool first = !s.newest_ns;
  s.newest_ns = stamp_ns;
  s.Advance(raw);
  if (first) {
    return s.StartKeyframe(position_m, MonocularStatus::kFirstFrame);
  }
  if (static_cast<int>(s.tracks.size()) < s.options.min_points) {
    return s.StartKeyframe(position_m, MonocularStatus::kLost);
  }
  return s.TrackFrame(position_m);
}

}  // namespace floorloc
