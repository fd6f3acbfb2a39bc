// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/descriptors.h"
#include "mapbuilder/laboratory/detectors.h"
#include "mapbuilder/laboratory/picture.h"

namespace floorloc {

/// Which keypoints of a picture are kept.
struct DetectionOptions {
  DetectorSettings settings = DetectorSettings::kLaboratory;
  double keypoints_per_m2 = 0.0;  ///< budget, spread evenly; 0: none
  int max_keypoints = 100'000;    ///< the strongest of the whole picture, so that no detector takes the machine
};

/// Keypoints of a picture, found tile by tile so that memory is bounded on any floor. Of a tile, `keypoints` are in
/// the pixels of `wide`, which reaches beyond it by the reach of a descriptor.
struct DetectedTile {
  cv::Rect wide;
  std::vector<cv::KeyPoint> keypoints;
};

struct DetectedPicture {
  std::vector<DetectedTile> tiles;
  double detect_ms = 0.0;

  std::size_t size() const;
};

struct DescribedPicture {
  Features features;  ///< in the picture's frame
  double describe_ms = 0.0;
};

/// Times are of the thread, not of the clock on the wall: they don't depend on what else the machine does.
DetectedPicture DetectKeypoints(const FloorPicture& picture, const Detector& detector, const DetectionOptions& options);
DescribedPicture DescribeKeypoints(const FloorPicture& picture, const DetectedPicture& detected,
                                   const Describer& describer);

/// Milliseconds that this thread has worked.
double ThreadMilliseconds();

}  // namespace floorloc
