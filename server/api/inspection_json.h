// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/serving/inspection.h"

namespace floorloc {

/// {"image","region","keypoints","poses"}, see Inspection in schema/openapi.yaml.
nlohmann::json FormatInspection(const Inspection& inspection);

}  // namespace floorloc
