// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {

/// How much of a view that shows more floor than the map's camera saw is looked at. Numbers: docs/benchmarks/views.md.
struct PartialViewOptions {
  /// Views larger than this many of the map's camera (area) are looked at in part: the whole takes 2.4 times as long as
  /// the map's own view at four of them, 5.7 times at nine. 0: never.
  double max_views = 2.0;
  /// Area in which keypoints are searched, in views of the map's camera: as much floor as the map's own frames show,
  /// which find themselves. The keypoints lie closer there than in the whole view: more hard frames are found.
  double keypoint_views = 1.0;
  /// Cells beside it, spread over the whole view, that are aligned to the mosaic: they hold the lever that tells a
  /// turned or tilted camera. Without them errors are 3 to 6 times as large, with 100 at four views 1.3 times.
  int outer_cells = 100;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Which pixels of a rectified view are looked at.
struct ViewParts {
  cv::Rect keypoints;
  std::vector<cv::Rect> outer;  ///< patches of some cells of FrameSamples, beside it
};

/// Chooses the parts of a view; the keypoints' part shows most floor of nine places, the middle before others. Empty
/// keypoints: the whole view is small enough. map_view_m2: area of the view of the map's camera.
ViewParts ChooseViewParts(const Rectifier& rectifier, double map_view_m2, const PartialViewOptions& options);

/// A view of which only parts are known.
struct PartialView {
  GroundImage keypoint_image;
  cv::Mat keypoint_prepared;  ///< FeatureExtractor::Prepare() of it
  GroundImage image;          ///< of the whole view, without its grey levels; the mask is 0 where nothing is known
  cv::Mat prepared;           ///< CV_8UC1 of its size
};

/// How parts are prepared.
struct PartPreparation {
  const FeatureExtractor& extractor;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();  ///< ReadoutMotion::motion of the image
};

/// Rectifies and prepares the parts only. raw: CV_8UC1 of the rectifier's camera.
PartialView RectifyParts(const Rectifier& rectifier, const cv::Mat& raw, const ViewParts& parts,
                         const PartPreparation& by);

}  // namespace floorloc
