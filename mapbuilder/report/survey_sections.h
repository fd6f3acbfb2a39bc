// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

// Of the surveys that the map was made from. Each returns one <section>, or an empty string when it has no content.

/// Empty when no camera has a mask.
std::string MaskSection(const ReportPage& page);
std::string ExposureSection(const ReportPage& page);
std::string DroppedSection(const ReportPage& page);
std::string OriginSection(const ReportPage& page);

}  // namespace floorloc
