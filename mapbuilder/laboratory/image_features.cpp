// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/image_features.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "core/vision/features/spread.h"

namespace floorloc {
namespace {

constexpr int kTilePx = 1024;
constexpr int kMarginPx = 96;
constexpr int kSpreadCellPx = 32;

// Excludes the border of the valid area, which is an artificial edge.
cv::Mat ErodedMask(const cv::Mat& mask) {
  cv::Mat eroded;
  cv::erode(mask, eroded, cv::Mat::ones(9, 9, CV_8U));
  return eroded;
}

std::vector<cv::Rect> CutTiles(const cv::Size& image) {
  std::vector<cv::Rect> tiles;
  for (int y = 0; y < image.height; y += kTilePx) {
    for (int x = 0; x < image.width; x += kTilePx) {
      tiles.push_back(cv::Rect(x, y, kTilePx, kTilePx) & cv::Rect({0, 0}, image));
    }
  }
  return tiles;
}

std::vector<cv::KeyPoint> Chosen(const std::vector<cv::KeyPoint>& keypoints, const std::vector<int>& indices) {
  std::vector<cv::KeyPoint> chosen;
  for (const int i : indices) {
    chosen.push_back(keypoints[static_cast<std::size_t>(i)]);
  }
  return chosen;
}

DetectedTile DetectTile(const FloorImage& image, const cv::Rect& tile, const Detector& detector,
                        const DetectionOptions& options) {
  const cv::Rect reach(tile.x - kMarginPx, tile.y - kMarginPx, tile.width + 2 * kMarginPx, tile.height + 2 * kMarginPx);
  DetectedTile detected{reach & cv::Rect({0, 0}, image.gray.size()), {}};
  const cv::Mat mask = image.mask(detected.wide);
  if (cv::countNonZero(image.mask(tile)) == 0) {
    return detected;
  }
  std::vector<cv::KeyPoint> keypoints = detector.Detect(image.gray(detected.wide), ErodedMask(mask));
  const cv::Rect2f inside(static_cast<float>(tile.x - detected.wide.x), static_cast<float>(tile.y - detected.wide.y),
                          static_cast<float>(tile.width), static_cast<float>(tile.height));
  std::erase_if(keypoints, [&](const cv::KeyPoint& k) { return !inside.contains(k.pt); });
  if (options.keypoints_per_m2 > 0.0) {
    const double area_m2 = cv::countNonZero(image.mask(tile)) * std::pow(image.resolution_m(), 2);
    const int budget = static_cast<int>(std::lround(area_m2 * options.keypoints_per_m2));
    keypoints = Chosen(keypoints, SpreadEvenly(keypoints, kSpreadCellPx, budget));
  }
  detected.keypoints = std::move(keypoints);
  return detected;
}

// Keeps the strongest keypoints over all tiles, at most `count`.
void KeepStrongest(std::size_t count, DetectedImage* detected) {
  std::vector<float> responses;
  for (const DetectedTile& tile : detected->tiles) {
    for (const cv::KeyPoint& k : tile.keypoints) {
      responses.push_back(k.response);
    }
  }
  if (responses.size() <= count) {
    return;
  }
  const auto last = responses.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(responses.begin(), last, responses.end(), std::greater<>());
  for (DetectedTile& tile : detected->tiles) {
    std::erase_if(tile.keypoints, [&](const cv::KeyPoint& k) { return k.response <= *last; });
  }
}

}  // namespace

std::size_t DetectedImage::size() const {
  std::size_t count = 0;
  for (const DetectedTile& tile : tiles) {
    count += tile.keypoints.size();
  }
  return count;
}

double ThreadMilliseconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

void DetectionOptions::Check() const {
  RequireOption(keypoints_per_m2 >= 0.0, "keypoints_per_m2 must be positive; 0: no budget");
  RequireOption(max_keypoints >= 1, "max_keypoints must be at least 1");
}

DetectedImage DetectKeypoints(const FloorImage& image, const Detector& detector, const DetectionOptions& options) {
  options.Check();
  const double start_ms = ThreadMilliseconds();
  DetectedImage detected;
  for (const cv::Rect& tile : CutTiles(image.gray.size())) {
    detected.tiles.push_back(DetectTile(image, tile, detector, options));
  }
  KeepStrongest(static_cast<std::size_t>(options.max_keypoints), &detected);
  detected.detect_ms = ThreadMilliseconds() - start_ms;
  return detected;
}

DescribedImage DescribeKeypoints(const FloorImage& image, const DetectedImage& detected,
                                 const DescriptorExtractor& descriptor_extractor) {
  const double start_ms = ThreadMilliseconds();
  DescribedImage described;
  for (const DetectedTile& tile : detected.tiles) {
    std::vector<cv::KeyPoint> keypoints = tile.keypoints;
    if (keypoints.empty()) {
      continue;
    }
    const cv::Mat descriptors = descriptor_extractor.Describe(image.gray(tile.wide), &keypoints);
    for (cv::KeyPoint& k : keypoints) {
      k.pt += cv::Point2f(tile.wide.tl());
      described.features.keypoints.push_back(image.ToFloor(k));
    }
    if (!keypoints.empty()) {
      described.features.descriptors.push_back(descriptors);
    }
  }
  described.describe_ms = ThreadMilliseconds() - start_ms;
  return described;
}

}  // namespace floorloc
