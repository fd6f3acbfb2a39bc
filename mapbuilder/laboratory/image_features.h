// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/descriptors.h"
#include "mapbuilder/laboratory/detectors.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// Which keypoints of an image are kept.
struct DetectionOptions {
  DetectorSettings settings = DetectorSettings::kLaboratory;
  double keypoints_per_m2 = 0.0;  ///< budget, spread evenly; 0: none
  int max_keypoints = 100'000;    ///< the strongest of the whole image, so that no detector takes the machine
};

/// Keypoints of an image, found tile by tile so that memory is bounded on any floor. Of a tile, `keypoints` are in
/// the pixels of `wide`, which reaches beyond it by the reach of a descriptor.
struct DetectedTile {
  cv::Rect wide;
  std::vector<cv::KeyPoint> keypoints;
};

struct DetectedImage {
  std::vector<DetectedTile> tiles;
  double detect_ms = 0.0;

  std::size_t size() const;
};

struct DescribedImage {
  Features features;  ///< in the image's frame
  double describe_ms = 0.0;
};

/// Times are of the thread, not of the clock on the wall: they don't depend on what else the machine does.
DetectedImage DetectKeypoints(const FloorImage& image, const Detector& detector, const DetectionOptions& options);
DescribedImage DescribeKeypoints(const FloorImage& image, const DetectedImage& detected,
                                 const DescriptorExtractor& descriptor_extractor);

/// Milliseconds that this thread has worked.
double ThreadMilliseconds();

}  // namespace floorloc
