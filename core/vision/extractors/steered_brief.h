// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Bytes of a descriptor.
constexpr int kBriefBytes = 32;
/// Radius of the support of orientation and descriptor, px: keypoints must be at least this far from the edge.
constexpr int kBriefReachPx = 17;

/// Sets the angle of every keypoint, degrees clockwise from the image's right, to the direction from its pixel to the
/// intensity centroid of its neighbourhood (Rosin 1999). image: CV_8UC1.
void OrientByCentroid(const cv::Mat& image, std::vector<cv::KeyPoint>* keypoints);

/// BRIEF (Calonder, Lepetit, Strecha & Fua 2010): 256 comparisons of two pixels about the keypoint, rotated by its
/// angle (Rublee, Rabaud, Konolige & Bradski 2011). smooth: CV_16SC1. Rows of kBriefBytes, CV_8U. The pairs are drawn
/// from the isotropic Gaussian of BRIEF's test design G II, with a fixed seed.
cv::Mat DescribeBrief(const cv::Mat& smooth, const std::vector<cv::KeyPoint>& keypoints);

/// The same with one angle for all points, degrees clockwise from the image's right: upright BRIEF in an image that is
/// turned by it. Of points nearer than kBriefReachPx to the edge all bits are 0.
cv::Mat DescribeBriefAt(const cv::Mat& smooth, const std::vector<cv::Point2f>& points, float angle_deg);

}  // namespace floorloc
