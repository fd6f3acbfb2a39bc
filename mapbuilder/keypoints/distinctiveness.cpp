// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/distinctiveness.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <random>

#include "core/geometry/option_check.h"
#include "core/vision/matching/descriptor_index.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Neighbours retrieved; usually more than the keypoints at one place.
constexpr int kNeighbours = 6;
// Buckets of the hash index to visit; the nearest neighbours need few.
constexpr int kProbes = 48;
constexpr int kChunk = 2048;

// Mean distance of two random descriptors; there must be at least two.
double MeanPairDistance(const cv::Mat& descriptors, std::uint32_t seed) {
  constexpr int kPairs = 2000;
  const int norm = descriptors.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2;
  const auto rows = static_cast<std::uint_fast32_t>(descriptors.rows);
  std::mt19937 random(seed);
  double sum = 0.0;
  for (int i = 0; i < kPairs; ++i) {
    const std::uint_fast32_t a = random() % rows;
    const std::uint_fast32_t b = (a + 1 + random() % (rows - 1)) % rows;  // differs from a
    sum += cv::norm(descriptors.row(static_cast<int>(a)), descriptors.row(static_cast<int>(b)), norm);
  }
  return std::max(sum / kPairs, 1e-9);
}

// Distance to the nearest neighbour at another place. If all retrieved neighbours are at this place, the distance of
// the last one is a lower bound.
double RivalDistance(const std::vector<Keypoint>& keypoints, std::size_t self, const std::vector<Neighbour>& found,
                     const DistinctivenessOptions& options, double mean_distance) {
  for (const Neighbour& n : found) {
    const Eigen::Vector2d position = keypoints[static_cast<std::size_t>(n.index)].Position();
    if ((position - keypoints[self].Position()).norm() > options.same_place_m) {
      return n.distance;
    }
  }
  return found.size() < kNeighbours ? mean_distance : found.back().distance;
}

}  // namespace

void DistinctivenessOptions::Check() const {
  RequireOption(same_place_m >= 0.0, "same_place_m must not be negative");
  run.Check();
}

std::vector<std::uint8_t> MeasureDistinctiveness(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors,
                                                 const DistinctivenessOptions& options) {
  options.Check();
  std::vector<std::uint8_t> result(keypoints.size(), 255);
  if (keypoints.size() < 2) {
    return result;
  }
  const double mean_distance = MeanPairDistance(descriptors, options.seed);
  IndexOptions index_options;
  index_options.seed = options.seed;
  const std::unique_ptr<DescriptorIndex> index = CreateDescriptorIndex(descriptors, index_options);
  const int chunks = (descriptors.rows + kChunk - 1) / kChunk;
  ParallelFor(chunks, options.run.threads, [&](int chunk) {
    const cv::Range rows(chunk * kChunk, std::min(descriptors.rows, (chunk + 1) * kChunk));
    const auto found = index->Search(descriptors.rowRange(rows), {.count = kNeighbours, .probes = kProbes});
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::size_t self = static_cast<std::size_t>(rows.start) + i;
      const double share = RivalDistance(keypoints, self, found[i], options, mean_distance) / mean_distance;
      result[self] = static_cast<std::uint8_t>(std::lround(255.0 * std::min(1.0, share)));
    }
  });
  return result;
}

}  // namespace floorloc
