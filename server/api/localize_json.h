// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/localization/localizer.h"
#include "server/api/pose_json.h"
#include "server/serving/camera_mask.h"
#include "server/serving/fix_history.h"
#include "server/serving/localize_service.h"
#include "server/wire/http_message.h"

namespace floorloc {

/// Parameters of a localize call, apart from the image.
struct LocalizeRequest {
  std::string vehicle;                ///< empty: the camera is inline
  std::optional<FloorCamera> camera;  ///< inline
  CameraMask mask;                    ///< of the inline camera; may be empty
  std::optional<bool> correct;        ///< the camera, by the map; empty: as the vehicle registered, or true
  std::optional<PosePrior> prior;
  std::optional<Eigen::Vector3d> twist;  ///< (vx, vy, wz) of the base at the image's time, m/s and rad/s
  std::optional<double> stamp_s;
  bool inspect = false;  ///< answer with an inspection
};

/// From the query: vehicle, prior=x,y,yaw, radius, twist=vx,vy,wz, stamp, inspect. Throws Problem 400
/// invalid_parameter.
LocalizeRequest ParseLocalizeQuery(const HttpRequest& request);
/// From the part `request`: the same fields, or camera and floor; and
/// correct_camera. Throws JsonError.
LocalizeRequest ParseLocalizeJson(const std::string& text);

/// The answer of localize.
std::string FormatLocalizeResponse(const FixRecord& record, const LocalizeOutcome& outcome);

/// The parts of a response about one image.
nlohmann::json FormatFix(const FixRecord& record);      ///< keypoint counts, residual, p_wrong, search
nlohmann::json FormatFixPose(const FixRecord& record);  ///< pose and covariance; for status localized only
nlohmann::json FormatAlternatives(const FixRecord& record);
nlohmann::json FormatAlternatives(const PoseLabel& label, const std::vector<PoseHypothesis>& hypotheses);
/// Adds "lattice", the pose modulo the floor's lattice, where the image tells it.
void AddLattice(const FixRecord& record, nlohmann::json* answer);
nlohmann::json FormatTiming(const LocalizeOutcome& outcome);

/// An element of GET /v1/maps/{map}/fixes.
nlohmann::json FormatFixRecord(const FixRecord& record);
/// {"fixes":[...],"next":SEQUENCE}
std::string FormatFixList(const std::vector<FixRecord>& records, std::uint64_t next);

}  // namespace floorloc
