// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/types.hpp>
#include <random>
#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// A straight piece of a segment's border.
struct BorderLine {
  double length_px = 0.0;
  double angle_rad = 0.0;  ///< 0 to pi, from the image's x axis towards its y axis
};

/// Straight pieces of at least 12 px among the points of a border, the longest found first, by RANSAC: lines through
/// two points, to which points within 1 px belong; the longest piece without a gap of more than 3 px counts, and its
/// points are taken away before the next line is sought.
std::vector<BorderLine> FindBorderLines(std::vector<cv::Point> border, std::mt19937_64* random);

/// Fills the group kShape: the lines' length per pixel of the border (regularity), mean and variance of their lengths,
/// their number, and the shares of 10 orientations. Where a segment ends at the image's edge there is no border.
void MeasureShape(const Segmentation& segmentation, std::uint64_t seed, std::vector<SegmentFeatures>* features);

}  // namespace floorloc
