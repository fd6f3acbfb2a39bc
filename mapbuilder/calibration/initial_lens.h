// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/calibration/lens_adjustment.h"

namespace floorloc {

/// Finds initial values: tries several focal lengths, from fisheye to tele, without distortion, with board poses from
/// their homographies (Zhang 2000), adjusts each by a few iterations and keeps the best. problem must have views (in
/// planes z = 0), model and width_px; returns false when nothing fits.
bool FindInitialLens(double height_px, LensAdjustment* problem);

}  // namespace floorloc
