// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace floorloc::client {

// The answers of the server, with the names of schema/openapi.yaml, which explains every field: SI units, radians, Unix
// seconds. Words of an enumeration stay text, so that a newer server's are not lost; what is absent is empty.

/// map_from_base: where the robot is.
struct Pose {
  std::string map;
  std::string map_version;
  double stamp = 0.0;
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  std::array<double, 9> covariance = {};  ///< of (x, y, yaw), row by row
};

struct Transform {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
};

/// Another pose that is consistent with the image.
struct Alternative {
  Transform map_from_base;
  int inliers = 0;
  double weight = 0.0;
};

/// The pose on a floor that repeats itself: the robot is at it, moved by a whole multiple of each vector of the basis.
struct LatticePose {
  std::array<std::array<double, 2>, 2> basis = {};  ///< two vectors (x, y), map frame, metres
  Transform pose;
  std::array<double, 9> covariance = {};  ///< of (x, y, yaw), row by row
  int places = 0;                         ///< how many such places the map has
};

struct Fix {
  int keypoints = 0;
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;
  double p_wrong = 1.0;
  std::string search;  ///< prior or global
  std::optional<double> support_area;
  std::string warning;
};

struct Timing {
  double queue_ms = 0.0;
  double total_ms = 0.0;
};

struct LocalizeAnswer {
  std::string status;  ///< localized, ambiguous or not_localized
  std::string reason;  ///< of not_localized
  std::optional<Pose> pose;
  Fix fix;
  std::vector<Alternative> alternatives;
  std::optional<LatticePose> lattice;
  Timing timing;
};

/// When the server wants the next image, whichever comes first; zero: now.
struct Next {
  double seconds = 0.0;
  double metres = 0.0;
};

struct SinceFix {
  double seconds = 0.0;
  double metres = 0.0;
  double radians = 0.0;
};

/// What the fixes say of the vehicle's odometry.
struct OdometryTrust {
  std::string health;  ///< ok, learning, suspect or rejected
  std::string reason;
  std::string cure;  ///< a sentence: what to do
};

/// The fused pose at the time of the vehicle's newest message.
struct TrackingAnswer {
  std::string status;  ///< localized, tracking_odometry or lost
  int epoch = 0;       ///< grows with each discontinuity of the pose
  std::string lost_reason;
  std::optional<Pose> pose;  ///< empty before the first fix, as the transforms
  std::optional<Transform> map_from_odom;
  std::optional<Transform> odom_from_base;
  std::optional<SinceFix> since_fix;
  std::optional<OdometryTrust> odometry;
  /// Where the robot may be, while its images do not tell the place on a floor that repeats itself; in a FrameAnswer
  /// else of the image alone.
  std::vector<Alternative> alternatives;
  Next next;
};

struct OdometryAnswer : TrackingAnswer {
  std::string message;                ///< what became of the last increment: used, used_late, duplicate, ...
  std::vector<std::string> messages;  ///< of each
};

/// What the image said by itself.
struct VehicleFix : Fix {
  std::string status;  ///< localized, ambiguous or not_localized
  std::string reason;
  bool accepted = false;
  bool reanchored = false;  ///< the vehicle was found elsewhere
  std::string reject_reason;
  std::optional<Pose> pose;
};

struct FrameAnswer : TrackingAnswer {
  std::string message;  ///< what became of the image: used, used_late, duplicate, ...
  VehicleFix fix;
  std::optional<LatticePose> lattice;
  Timing timing;
};

// All throw nlohmann::json::exception for what is no such answer.
LocalizeAnswer ParseLocalizeAnswer(const nlohmann::json& object);
TrackingAnswer ParseTrackingAnswer(const nlohmann::json& object);
OdometryAnswer ParseOdometryAnswer(const nlohmann::json& object);
FrameAnswer ParseFrameAnswer(const nlohmann::json& object);

}  // namespace floorloc::client
