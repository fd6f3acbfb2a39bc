// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/descriptors.h"
#include "mapbuilder/laboratory/detectors.h"
#include "mapbuilder/laboratory/floor_image.h"

namespace floorloc {

/// Selection of an image's keypoints.
struct DetectionOptions {
  DetectorSettings settings = DetectorSettings::kLaboratory;
  double keypoints_per_m2 = 0.0;  ///< budget, spread evenly; 0: none
  int max_keypoints = 100'000;    ///< the strongest of the whole image, so that no detector takes the machine

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Keypoints of one tile; detection by tiles bounds memory for floors of any size. `keypoints` are in pixels of `wide`,
/// which is the tile enlarged by the radius of a descriptor.
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

/// Times are CPU times of the thread, independent of other load on the machine.
DetectedImage DetectKeypoints(const FloorImage& image, const Detector& detector, const DetectionOptions& options);
DescribedImage DescribeKeypoints(const FloorImage& image, const DetectedImage& detected,
                                 const DescriptorExtractor& descriptor_extractor);

/// CPU time of this thread, milliseconds.
double ThreadMilliseconds();

}  // namespace floorloc
