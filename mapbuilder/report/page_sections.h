// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/report_html.h"

namespace floorloc {

// Each returns one <section>, or an empty string when it has no content.

std::string VerdictSection(const ReportPage& page);
std::string ResurveySection(const ReportPage& page);
std::string GeometrySection(const ReportPage& page);
std::string HeldOutSection(const ReportPage& page);
/// Empty when no camera has a mask.
std::string MaskSection(const ReportPage& page);
std::string ExposureSection(const ReportPage& page);
std::string DroppedSection(const ReportPage& page);
std::string OriginSection(const ReportPage& page);

}  // namespace floorloc
