// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

// Of the map. Each returns one <section>, or an empty string when it has no content.

std::string VerdictSection(const ReportPage& page);
std::string ResurveySection(const ReportPage& page);
std::string GeometrySection(const ReportPage& page);
std::string HeldOutSection(const ReportPage& page);

}  // namespace floorloc
