// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// The page's content as numbers: verdict, zones ("resurvey", most important first), distributions, the build.
std::string ReportJson(const MapEvidence& evidence, const MapQuality& quality, const Verdict& verdict);

}  // namespace floorloc
