// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/features/dlib_surf.h"

#include <dlib/image_keypoint/surf.h>
#include <dlib/opencv/cv_image.h>

#include <numbers>

#include "core/vision/surf/surf.h"

namespace floorloc {

ImageFeatures DlibSurf(const cv::Mat& gray, double threshold, int max_keypoints) {
  const dlib::cv_image<unsigned char> image(gray);
  const std::vector<dlib::surf_point> points = dlib::get_surf_points(image, max_keypoints, threshold);
  ImageFeatures features;
  features.descriptors.create(static_cast<int>(points.size()), kSurfLength, CV_32FC1);
  for (int i = 0; i < features.descriptors.rows; ++i) {
    const dlib::surf_point& point = points[static_cast<std::size_t>(i)];
    features.keypoints.emplace_back(static_cast<float>(point.p.center.x()), static_cast<float>(point.p.center.y()),
                                    static_cast<float>(point.p.scale) / kSurfScalePerSize,
                                    static_cast<float>(point.angle * 180.0 / std::numbers::pi),
                                    static_cast<float>(point.p.score));
    for (int k = 0; k < kSurfLength; ++k) {
      features.descriptors.at<float>(i, k) = static_cast<float>(point.des(k));
    }
  }
  return features;
}

}  // namespace floorloc
