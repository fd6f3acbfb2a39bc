// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

/// The mosaic with its layers: first as one map with switches, then one image per layer.
std::string MapSections(const ReportPage& page);

}  // namespace floorloc
