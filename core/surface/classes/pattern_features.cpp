// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/pattern_features.h"

#include <bit>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr std::array<int, 3> kRadiiPx = {1, 2, 4};
constexpr int kCodes = 10;  // 0 to 8 neighbours set in one arc, and all other patterns
constexpr std::size_t kBins = kRadiiPx.size() * kCodes;
constexpr double kSigmaPerRadius = 0.5;  // a neighbour stands for its surroundings

constexpr std::array<std::uint8_t, 256> MakeCodes() {
  std::array<std::uint8_t, 256> codes = {};
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    const auto bits = static_cast<std::uint8_t>(pattern);
    const int changes = std::popcount(static_cast<std::uint8_t>(bits ^ std::rotl(bits, 1)));
    codes[pattern] = static_cast<std::uint8_t>(changes <= 2 ? std::popcount(bits) : kCodes - 1);
  }
  return codes;
}

constexpr std::array<std::uint8_t, 256> kCodeOf = MakeCodes();

using RowsAround = std::array<const std::uint8_t*, 8>;

// The 8 neighbours of (0, y), in circular order; diagonal ones on the circle, rounded.
RowsAround Neighbours(const cv::Mat& padded, int y, int radius) {
  const int slanted = (radius * 181 + 128) / 256;  // radius / sqrt(2)
  const std::array<cv::Point, 8> offsets = {{{radius, 0},
                                             {slanted, slanted},
                                             {0, radius},
                                             {-slanted, slanted},
                                             {-radius, 0},
                                             {-slanted, -slanted},
                                             {0, -radius},
                                             {slanted, -slanted}}};
  RowsAround rows = {};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = padded.ptr<std::uint8_t>(y + radius + offsets[i].y) + radius + offsets[i].x;
  }
  return rows;
}

void PatternsOfRow(const RowsAround& around, const std::uint8_t* centre, int threshold,
                   std::vector<std::uint8_t>* row) {
  for (std::size_t x = 0; x < row->size(); ++x) {
    unsigned pattern = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
      pattern |= static_cast<unsigned>(around[i][x] >= centre[x] + threshold) << i;
    }
    (*row)[x] = static_cast<std::uint8_t>(pattern);
  }
}

cv::Mat Pad(const cv::Mat& gray, int radius) {
  cv::Mat padded;
  if (radius > 1) {
    cv::GaussianBlur(gray, padded, {}, kSigmaPerRadius * radius);
  } else {
    padded = gray;
  }
  cv::copyMakeBorder(padded, padded, radius, radius, radius, radius, cv::BORDER_REPLICATE);
  return padded;
}

}  // namespace

void MeasurePattern(const cv::Mat& gray, const Segmentation& segmentation, int threshold,
                    std::vector<SegmentFeatures>* features) {
  std::vector<std::array<int, kBins>> counts(features->size());
  std::vector<std::uint8_t> patterns(static_cast<std::size_t>(gray.cols));
  for (std::size_t scale = 0; scale < kRadiiPx.size(); ++scale) {
    const int radius = kRadiiPx[scale];
    const cv::Mat padded = Pad(gray, radius);
    for (int y = 0; y < gray.rows; ++y) {
      PatternsOfRow(Neighbours(padded, y, radius), padded.ptr<std::uint8_t>(y + radius) + radius, threshold, &patterns);
      const int* labels = segmentation.labels.ptr<int>(y);
      for (std::size_t x = 0; x < patterns.size(); ++x) {
        ++counts[static_cast<std::size_t>(labels[x])][scale * kCodes + kCodeOf[patterns[x]]];
      }
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    auto& group = (*features)[i].groups[static_cast<std::size_t>(FeatureGroup::kPattern)];
    for (const int count : counts[i]) {
      group.push_back(static_cast<float>(count) / static_cast<float>((*features)[i].pixels));
    }
  }
}

}  // namespace floorloc
