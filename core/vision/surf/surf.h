// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "core/vision/image/box_sampler.h"
#include "core/vision/image/integral_image.h"

namespace floorloc {

/// Whether this build has SURF (FLOORLOC_WITH_SURF).
bool SurfAvailable();

/// Parameters of the SURF detector and descriptor.
struct SurfOptions {
  double threshold = 3.0;  ///< least determinant of the Hessian, (grey levels)^2, filters normalised by their area
  int octaves = 2;         ///< each octave doubles the range of scales; 1 to 8
  int layers = 2;          ///< scales per octave at which keypoints are detected; 1 to 8
  int first_step_px = 1;   ///< between the samples of the first octave, 1 or 2; doubled from octave to octave
  int max_keypoints = 0;   ///< the strongest are kept; 0: all
  bool upright = false;    ///< no orientation (angle 0): faster, for images of the same orientation

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Speeded-Up Robust Features after Bay, Ess, Tuytelaars and Van Gool (CVIU 2008). Const and thread-safe.
///
/// Keypoints are blobs: pt has (0, 0) in the centre of the top-left pixel; size is the side of the box filter with the
/// strongest response, px (9 px belong to the scale s = 1.2 px); angle is in degrees clockwise from the image's right;
/// response is the determinant of the Hessian; octave counts from 0; class_id is 1 for dark blobs on bright ground and
/// -1 for bright ones on dark (the sign of the Laplacian).
class Surf {
 public:
  /// Throws std::invalid_argument when the options do not pass Check(), or when SURF was left out of the build.
  explicit Surf(const SurfOptions& options);

  /// Keypoints with their angles, strongest first. gray: CV_8UC1; mask: empty, or zero where keypoints are excluded.
  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask = cv::Mat()) const;

  /// One row of 64 numbers (CV_32F, length 1) per keypoint. Keypoints nearer to the image's edge than the descriptor
  /// reaches (SurfReachPx) are dropped; those of other detectors without an angle (below 0) are given SURF's.
  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const;

  /// Detect and Describe with one integral image; *keypoints are those that have a descriptor.
  cv::Mat DetectAndDescribe(const cv::Mat& gray, const cv::Mat& mask, std::vector<cv::KeyPoint>* keypoints) const;

  /// The stages, for callers that select keypoints in between. Find leaves the angle at -1; Orient sets the angle of
  /// keypoints without one (upright: 0 for all), as Describe does first.
  std::vector<cv::KeyPoint> Find(const IntegralImage& integral, const cv::Mat& mask = cv::Mat()) const;
  void Orient(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const;
  cv::Mat Describe(const IntegralImage& integral, std::vector<cv::KeyPoint>* keypoints) const;

 private:
  void Orient(BoxSampler* sampler, std::vector<cv::KeyPoint>* keypoints) const;

  SurfOptions options_;
};

constexpr int kSurfLength = 64;                   ///< numbers per descriptor
constexpr float kSurfScalePerSize = 1.2F / 9.0F;  ///< the scale of a filter of 9 px is 1.2 px

/// Radius of the descriptor's support for any orientation, px.
inline float SurfReachPx(const cv::KeyPoint& keypoint) {
  // The corners of the grid of boxes, 20 scales square, half a box of about one scale, and rounding.
  return 15.0F * kSurfScalePerSize * keypoint.size + 2.0F;
}

}  // namespace floorloc
