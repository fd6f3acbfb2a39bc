// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/surface/classes/surface_classifier.h"

namespace floorloc {

/// A colour for each class, BGR.
cv::Scalar ClassColor(int label);

/// The picture (CV_8UC3) with every pixel tinted by its class (CV_32SC1 of any size, enlarged to the picture; negative:
/// none), and a legend of the classes.
cv::Mat TintByClass(const cv::Mat& picture, const cv::Mat& class_of_pixel, const std::vector<std::string>& classes);

/// The class of every pixel (CV_32SC1) of a classified picture.
cv::Mat ClassOfPixel(const SurfaceResult& result);

}  // namespace floorloc
