// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/build/build_options.h"
#include "mapbuilder/build/build_report.h"

namespace floorloc {

/// Builds a map file from surveys. With `extend`, the frames and the coordinate frame of that map are kept; the report
/// counts frames and links of the new surveys only, but area and keypoints of the whole map. Throws InputError or
/// MapError, leaving an existing output file untouched.
BuildReport BuildMap(const BuildOptions& requested);

}  // namespace floorloc
