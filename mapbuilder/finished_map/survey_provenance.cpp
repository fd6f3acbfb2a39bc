// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/survey_provenance.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/map/map_error.h"

namespace floorloc {

std::vector<SurveyProvenance> ReadProvenance(const MapInfo& info) {
  std::vector<SurveyProvenance> provenance(info.cameras.size());
  try {
    const auto surveys = nlohmann::json::parse(info.surveys_json);
    for (std::size_t i = 0; i < std::min(provenance.size(), surveys.size()); ++i) {
      const nlohmann::json& survey = surveys.at(i);
      provenance[i] = {survey.value("folder", ""), survey.value("camera", ""), survey.value("frames", std::int64_t{0}),
                       survey.value("odometry", false), survey.value("mounting", "")};
    }
  } catch (const nlohmann::json::exception& error) {
    throw MapError("the list of surveys in the map is damaged (" + std::string(error.what()) +
                       "); restore the map from a copy or build it again",
                   MapError::Kind::kDamaged);
  }
  return provenance;
}

}  // namespace floorloc
