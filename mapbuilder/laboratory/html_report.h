// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/laboratory/laboratory.h"

namespace floorloc {

/// Self-contained page with plots and all tables.
std::string ToHtml(const LaboratoryReport& report);

}  // namespace floorloc
