// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace floorloc {

/// When and how the blur of a moving camera is undone. Numbers: docs/benchmarks/blur.md.
struct MotionBlurOptions {
  double min_length_px = 7.0;   ///< frames with less blur are found as they are
  double max_length_px = 48.0;  ///< beyond, too little is left
  /// Least depth of the dip in the autocorrelation of the slope along the motion, as a share of its peak: 0.5 for a
  /// clean image, 0.11 to 0.25 for blur of 20 px and more.
  double min_dip = 0.08;
  double noise_share = 0.1;  ///< power of the noise as a share of the image's (Wiener's filter); 0.03 to 0.3 find alike
  double max_exposure_s = 0.02;  ///< longest exposure of a camera that moves: slower motion blurs less than the minimum

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Measures linear motion blur along a direction and undoes it (Wiener's filter). The autocorrelation of the image's
/// slope along the motion has its minimum at the blur's length (Yitzhaky & Kopeika 1997). normalized: CV_8UC1, mean
/// 128. direction: unit vector, pixels to the right and down. Returns an image of the same kind; empty where no such
/// blur is seen.
std::optional<cv::Mat> UndoMotionBlur(const cv::Mat& normalized, const Eigen::Vector2d& direction,
                                      const MotionBlurOptions& options = {});

}  // namespace floorloc
