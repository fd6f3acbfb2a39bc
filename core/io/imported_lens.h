// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/geometry/camera.h"
#include "core/io/yaml_entry.h"

namespace floorloc {

/// What a file says of a lens, in the words of its tool.
struct LensSource {
  std::optional<YamlEntry> model;          ///< its name: radtan, plumb_bob, equidistant, fisheye, ...
  std::optional<YamlEntry> numbers;        ///< distortion coefficients
  std::optional<DistortionModel> assumed;  ///< where there is no name; empty: the number of coefficients tells it
};

/// Sets distortion model and coefficients. Trailing zeros beyond the model's coefficients are dropped; OpenCV's thin
/// prism and tilted sensor are refused, as are 4 coefficients of an unnamed model: a fisheye's or a pinhole camera's.
/// Throws InputError.
void ReadLens(const YamlDocument& document, const LensSource& lens_source, CameraModel* camera);

}  // namespace floorloc
