// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

/// How much a frame's pixels count, from 0 at the border of what it saw to 1 in its middle.
struct FeatherWeights {
  cv::Mat sharp;  ///< CV_32F, falls steeply: one frame dominates, small misplacements do not blur
  cv::Mat soft;   ///< CV_32F, at the low band's size, falls slowly: light fades over wide seams
};

/// mask: CV_8UC1, 255 where the frame saw the floor.
FeatherWeights MakeFeatherWeights(const cv::Mat& mask);

/// A picture split into detail and light (Burt & Adelson 1983, with two bands), each times its weights.
struct BandedPicture {
  cv::Mat detail;  ///< CV_32FC3
  cv::Mat light;   ///< CV_32FC3, at the low band's size
};

/// picture: CV_32FC3, zero where mask is.
BandedPicture SplitBands(const cv::Mat& picture, const cv::Mat& mask, const FeatherWeights& feather);

/// Blends rectified frames into a square patch: light over wide seams, detail over narrow ones.
class TwoBandBlender {
 public:
  explicit TwoBandBlender(int side_px);

  /// frame_from_patch: 2x3 affine transform, patch pixel -> frame pixel. The order of the frames decides the last bits.
  void Add(const BandedPicture& picture, const FeatherWeights& feather, const cv::Mat& frame_from_patch);

  /// CV_8UC3, zero where no frame saw the floor; `seen`: CV_8UC1, 255 or 0.
  void Finish(cv::Mat* bgr, cv::Mat* seen) const;

 private:
  struct Band {
    cv::Mat sum;
    cv::Mat weight;

    explicit Band(int side_px);
    void Add(const cv::Mat& weighted, const cv::Mat& feather, const cv::Mat& frame_from_patch);
    cv::Mat Mean() const;
  };
  Band detail_;
  Band light_;
};

}  // namespace floorloc
