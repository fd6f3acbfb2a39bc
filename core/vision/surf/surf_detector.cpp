// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf_detector.h"

#include <array>

#include "core/vision/features/response_peaks.h"
#include "core/vision/surf/surf_response.h"

namespace floorloc {
namespace {

cv::KeyPoint ToKeypoint(const IntegralImage& integral, int octave, const ResponseLayer* layer,
                        const ResponsePeak& peak) {
  const auto step = static_cast<float>(layer->step_px);
  const auto size_step = static_cast<float>(layer->filter_px - (layer - 1)->filter_px);
  const bool dark = LaplacianAt(integral, layer->filter_px, peak.i * layer->step_px, peak.j * layer->step_px) > 0.0F;
  return {(static_cast<float>(peak.i) + peak.offset[0]) * step,
          (static_cast<float>(peak.j) + peak.offset[1]) * step,
          static_cast<float>(layer->filter_px) + peak.offset[2] * size_step,
          -1.0F,
          peak.value,
          octave,
          dark ? 1 : -1};
}

}  // namespace

std::vector<cv::KeyPoint> DetectFastHessian(const IntegralImage& integral, const SurfOptions& options) {
  const auto threshold = static_cast<float>(options.threshold);
  std::vector<cv::KeyPoint> found;
  ResponseOctave layers;
  for (int octave = 0; octave < options.octaves; ++octave) {
    layers = ComputeOctave(integral, octave, options.layers + 2, layers, options.first_step_px);
    for (std::size_t i = 1; i + 1 < layers.size(); ++i) {
      const std::array<cv::Mat, 3> responses{layers[i - 1].response, layers[i].response, layers[i + 1].response};
      for (const ResponsePeak& peak : FindPeaks(responses, layers[i + 1].margin, threshold)) {
        found.push_back(ToKeypoint(integral, octave, &layers[i], peak));
      }
    }
  }
  return found;
}

}  // namespace floorloc
