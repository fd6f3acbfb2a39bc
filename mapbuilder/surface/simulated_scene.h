// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "core/surface/classes/surface_image.h"

namespace floorloc {

/// A view of several floors at once, as an RGB-D camera or a camera with a registered lidar sees them.
struct SurfaceScene {
  SurfaceImage image;
  cv::Mat class_of_pixel;  ///< CV_32SC1: index into SceneClasses()
};

struct SceneOptions {
  cv::Size size_px = {640, 480};
  double focal_px = 525.0;
  double camera_height_m = 0.9;
  double camera_pitch_rad = 0.87;  ///< downwards from the horizontal
  double range_noise_m = 0.01;     ///< standard deviation of a pixel's depth (Hokuyo UTM-30LX)
  double hole_share = 0.15;        ///< of the pixels, two thirds alone, one third in patches
  double surface_variance = 0.25;  ///< share of an intensity's variance that is common to a whole surface,
  double patch_variance = 0.25;    ///< and that changes over a few centimetres; the rest is noise of each pixel
  double light_change = 0.25;      ///< largest relative change of the light, between scenes and over a scene
  double color_change = 0.1;       ///< largest relative change of a channel, of the light and of each surface

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// "carpet", "concrete", "linoleum", "rough_wood", "smooth_wood".
std::vector<std::string> SceneClasses();

/// How many units of an intensity image are one unit of the lidar's intensity.
constexpr double kIntensityUnits = 1000.0;

/// Mean and standard deviation of the lidar intensity of a class, as measured on real materials.
struct IntensityStatistics {
  double mean = 0.0;
  double sigma = 0.0;
};
IntensityStatistics IntensityOf(int scene_class);

/// A floor parted by two lines into up to four surfaces of different classes, seen by a camera that looks down
/// obliquely. Intensities are log-normal with the mean and standard deviation of their class. Different seeds give
/// different floors; deterministic. Throws std::invalid_argument when the options do not pass Check().
SurfaceScene SimulateScene(const SceneOptions& options, std::uint64_t seed);

}  // namespace floorloc
