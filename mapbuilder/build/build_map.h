// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/build/build_options.h"
#include "mapbuilder/build/build_report.h"

namespace floorloc {

/// Surveys -> map file. With `extend` the frames and the frame of that map stay as they are; the report's frames and
/// links are the new ones, its floor and keypoints those of the whole map. Throws InputError or MapError; the old file
/// stays as it was then.
BuildReport BuildMap(const BuildOptions& requested);

}  // namespace floorloc
