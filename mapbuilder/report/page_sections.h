// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

// Each gives one <section>, empty when there is nothing to say.

std::string VerdictSection(const ReportPage& page);
std::string ResurveySection(const ReportPage& page);
std::string GeometrySection(const ReportPage& page);
std::string HeldOutSection(const ReportPage& page);
std::string ExposureSection(const ReportPage& page);
std::string DroppedSection(const ReportPage& page);
std::string OriginSection(const ReportPage& page);

}  // namespace floorloc
