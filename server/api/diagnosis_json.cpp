// SPDX-License-Identifier: Apache-2.0
#include "server/api/diagnosis_json.h"

#include <nlohmann/json.hpp>

#include "core/diagnosis/diagnosis.h"
#include "server/wire/strict_json.h"

namespace floorloc {

std::string FormatDiagnosis(const VehicleState& state) {
  const FloorCamera& camera = state.vehicle->in_map.rectifier->camera();
  const CameraEstimate estimate = state.session->Camera();
  const double off_px = LargestDisplacementPx(camera, estimate.errors.mean);
  const std::vector<Finding> findings =
      Diagnose(state.session->Record(), ObservedCamera::Of(estimate, off_px, camera), std::nullopt);
  nlohmann::json list = nlohmann::json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"about", finding.about},
                    {"status", ToString(finding.status)},
                    {"sentence", finding.sentence},
                    {"cure", finding.cure}});
  }
  return ToText(
      {{"vehicle", state.vehicle->id}, {"status", ToString(WorstOf(findings))}, {"findings", std::move(list)}});
}

}  // namespace floorloc
