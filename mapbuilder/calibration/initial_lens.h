// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/calibration/lens_adjustment.h"

namespace floorloc {

/// A lens without distortion and places of the boards to start from: several focal lengths are tried, from fisheye to
/// tele, the boards placed by their homographies (Zhang 2000), and each try adjusted by a few steps; the best one
/// stays. problem has views (in planes z = 0), model and width_px; false when nothing fits.
bool FindInitialLens(double height_px, LensAdjustment* problem);

}  // namespace floorloc
