// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

/// The mosaic with its layers: one interactive map, then one image per layer.
std::string MapSections(const ReportPage& page);

}  // namespace floorloc
