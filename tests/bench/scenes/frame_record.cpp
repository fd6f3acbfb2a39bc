// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/frame_record.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/evaluation/fix_score.h"

namespace floorloc {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity: null replaces it.
double NumberOrInfinity(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

LocalizationStatus ParseStatus(const std::string& name) {
  for (const LocalizationStatus status :
       {LocalizationStatus::kLocalized, LocalizationStatus::kAmbiguous, LocalizationStatus::kNotLocalized}) {
    if (name == ToString(status)) {
      return status;
    }
  }
  throw std::invalid_argument("unknown status '" + name + "'");
}

Json ToJson(const FixRecord& fix) {
  return {{"search", ToString(fix.search)},
          {"status", ToString(fix.status)},
          {"has_pose", fix.has_pose},
          {"p_wrong", fix.p_wrong},
          {"error_m", fix.error_m},
          {"error_rad", fix.error_rad},
          {"nees", fix.nees},
          {"inliers", fix.inliers},
          {"support_area", fix.support_area ? Json(*fix.support_area) : Json()},
          {"truth_listed", fix.truth_listed},
          {"localize_ms", fix.localize_ms}};
}

FixRecord ParseFix(const Json& json) {
  return {ParseSearchKind(json.at("search")),
          ParseStatus(json.at("status")),
          json.at("has_pose"),
          json.at("p_wrong"),
          NumberOrInfinity(json.at("error_m")),
          NumberOrInfinity(json.at("error_rad")),
          NumberOrInfinity(json.at("nees")),
          json.at("inliers"),
          json.at("support_area").is_null() ? std::nullopt : std::optional<double>(json.at("support_area")),
          json.at("truth_listed"),
          json.at("localize_ms")};
}

}  // namespace

bool FixRecord::wrong() const {
  const Tolerance tolerance;
  return has_pose && !(error_m <= tolerance.position_m && error_rad <= tolerance.yaw_rad);
}

std::string ToJsonLine(const FrameRecord& record) {
  Json json = {{"frame", record.frame},
               {"place", ToString(record.place)},
               {"condition", record.condition},
               {"render_ms", record.render_ms},
               {"fixes", Json::array()}};
  for (const FixRecord& fix : record.fixes) {
    json["fixes"].push_back(ToJson(fix));
  }
  return json.dump();
}

FrameRecord ParseFrameRecord(const std::string& line) {
  const Json json = Json::parse(line);
  FrameRecord record{
      json.at("frame"), ParseFramePlace(json.at("place")), json.at("condition"), json.at("render_ms"), {}};
  for (const Json& fix : json.at("fixes")) {
    record.fixes.push_back(ParseFix(fix));
  }
  return record;
}

}  // namespace floorloc
