// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/map/map_database.h"
#include "tests/bench/scenes/scene.h"

namespace floorloc {

/// How well descriptors of frames match those of a map, over keypoints whose true map keypoint is known.
struct DescriptorScore {
  static constexpr int kBits = 256;

  std::int64_t queries = 0;
  std::int64_t right = 0;                    ///< the nearest descriptor of the whole map is at the true place
  std::vector<int> true_distance;            ///< bits, to the true keypoint, one per query
  std::vector<std::int64_t> wrong_distance;  ///< histogram over bits, to a sample of the keypoints elsewhere

  DescriptorScore() : wrong_distance(kBits + 1, 0) {}
  void Add(const DescriptorScore& other);
  double RankOneShare() const;
  /// Share of the keypoints elsewhere that are as near as the given share of the true ones.
  double FalseShareAtRecall(double recall) const;
};

/// Results of one group of frames.
struct DescriptorTally {
  std::int64_t keypoints = 0;              ///< of the frames
  std::int64_t repeated = 0;               ///< with a keypoint of the map at their place
  std::int64_t angles_within_10 = 0;       ///< whose angle is within 10 degrees of that keypoint's
  std::map<int, DescriptorScore> upright;  ///< by the error of the given heading, degrees
  DescriptorScore steered;

  void Add(const DescriptorTally& other);
};

/// Compares the frames of a group with a map of the default extractor. map_from_truth: by the survey's ground truth.
/// What vibration moves the image by is taken out by an affine fit to its matches (RANSAC); frames without such a fit
/// are left out.
DescriptorTally TryDescriptors(const MapDatabase& database, const FrameGroup& group, const Pose2& map_from_truth);

}  // namespace floorloc
