// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/calibration/camera_calibration.h"

namespace floorloc {

/// What a calibration is worth, as CameraModel::sigma_px: standard deviation of a coordinate, px, at the worst place of
/// the image within calibrated_radius_px of the principal point. Two parts, added as squares: the covariance of the
/// lens, without what another pose of the camera would explain (floor.yaml is measured with this lens), and the
/// reprojection error, which bounds from above what the lens model does not describe: it holds the noise of the
/// corners, too. Without a covariance the reprojection error alone.
double CalibrationSigmaPx(const CameraCalibration& calibration, double calibrated_radius_px);

}  // namespace floorloc
