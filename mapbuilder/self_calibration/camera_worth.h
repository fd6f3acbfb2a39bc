// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/self_calibration/camera_adjustment.h"

namespace floorloc {

/// The calibrated camera with what it is worth: CameraModel::sigma_px, of its corners relative to its centre, and
/// FloorPlane::offset_sigma_m, of its centre. covariance: of its unknowns; unmodelled_px: what they do not describe, at
/// the corners.
FloorCamera WithSigmas(FloorCamera camera, const CameraCovariance& covariance, double unmodelled_px);

}  // namespace floorloc
