// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"

namespace floorloc {

/// The determinant of the Hessian on a grid of samples, for one size of box filters.
struct ResponseLayer {
  int filter_px = 0;  ///< side of the box filters: 3 (2^octave times a whole number) + 3
  int step_px = 0;    ///< sample (i, j) is at pixel (i * step_px, j * step_px)
  int margin = 0;     ///< samples along each edge where the filter does not fit; they are 0
  cv::Mat response;   ///< CV_32F

  const float* row(int j) const { return response.ptr<float>(j); }
};

/// The responses of one octave, from the smallest filter to the largest.
using ResponseOctave = std::vector<ResponseLayer>;

/// Octave 0 is sampled every first_step_px; later ones reuse the layers that they share with the previous one. Fewer
/// layers than requested where filters exceed the image.
ResponseOctave ComputeOctave(const IntegralImage& integral, int octave, int layers, const ResponseOctave& previous,
                             int first_step_px);

/// Sum of the second derivatives at a pixel where the filter fits; its sign distinguishes dark blobs (+) from bright
/// ones (-).
float LaplacianAt(const IntegralImage& integral, int filter_px, int x, int y);

}  // namespace floorloc
