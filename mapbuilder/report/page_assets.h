// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace floorloc {

std::string_view ReportStyle();   ///< report.css
std::string_view ReportScript();  ///< report.js

}  // namespace floorloc
