// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/laboratory/laboratory.h"

namespace floorloc {

/// One page with plots and all tables; it needs nothing but itself.
std::string ToHtml(const LaboratoryReport& report);

}  // namespace floorloc
