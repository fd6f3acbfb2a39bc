// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "mapbuilder/bag/ros_messages.h"

namespace floorloc {

/// The camera of a CameraInfo: K and D, or, of rectified images, P without distortion; binning and region of interest
/// are applied as image_geometry does (wiki.ros.org/image_pipeline/CameraInfo). `name`: of the camera. Throws
/// InputError with the reason, which names `topic` and --camera.
CameraModel CameraOfInfo(const RosCameraInfo& info, bool rectified, const std::string& name, const std::string& topic);

}  // namespace floorloc
