// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "core/geometry/camera.h"

namespace floorloc {

/// fx, fy, cx, cy in units of the image width, so that all parameters are of similar magnitude, and up to 8 distortion
/// coefficients.
constexpr int kLensParameters = 12;
constexpr int kFirstCoefficient = 4;
using LensParameters = std::array<double, kLensParameters>;

/// CameraModel::Distort for any scalar type, for automatic differentiation: a point of the plane z = 1 in front of the
/// camera -> raw pixel in units of the image width.
template <typename T>
std::array<T, 2> ProjectThroughLens(DistortionModel model, const T* lens, const T& x, const T& y) {
  const T* k = lens + kFirstCoefficient;
  const T r2 = x * x + y * y;
  T distorted_x = x;
  T distorted_y = y;
  if (model == DistortionModel::kEquidistant) {
    if (r2 > T(1e-16)) {
      using std::atan;
      using std::sqrt;
      const T r = sqrt(r2);
      const T theta = atan(r);
      const T t2 = theta * theta;
      const T share = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r;
      distorted_x = x * share;
      distorted_y = y * share;
    }
  } else {
    const T radial = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    distorted_x = x * radial + 2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x);
    distorted_y = y * radial + k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y;
  }
  return {lens[0] * distorted_x + lens[2], lens[1] * distorted_y + lens[3]};
}

}  // namespace floorloc
