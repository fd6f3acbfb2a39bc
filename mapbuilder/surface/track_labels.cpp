// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/track_labels.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "core/io/floor_picture.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr std::size_t kRough = 0;  // in kTextureClasses
constexpr std::size_t kSmooth = 1;

// Keypoints of an image, and its blocks.
struct TrackedImage {
  PatchedImage points;
  std::vector<TextureBlock> blocks;
};

TrackedImage ReadTracked(const std::filesystem::path& file, const SequenceImageOptions& images,
                         const TrackLabelOptions& options) {
  const cv::Mat gray = ReducedGray(ReadPictureOfAnySize(file), images.width_px);
  if (gray.cols < images.grid.columns || gray.rows < images.grid.rows) {
    throw InputError(file, "has fewer pixels than blocks are to be made of it; give larger images");
  }
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(gray, keypoints, options.fast_threshold);
  cv::KeyPointsFilter::retainBest(keypoints, options.max_points);
  return {CutPatches(gray, keypoints, options.tracker), MeasureTextureBlocks(gray, images.grid)};
}

// The points of the first image that are tracked into the second.
std::vector<cv::Point2f> TrackedPoints(const TrackedImage& image, const TrackedImage& next,
                                       const PatchTrackerOptions& options) {
  const std::vector<PatchMatch> matches = MatchPatches(image.points, next.points, options);
  std::vector<cv::Point2f> tracked;
  for (const int i : EstimatePatchMotion(image.points, next.points, matches, options).inliers) {
    tracked.push_back(image.points.points[static_cast<std::size_t>(matches[static_cast<std::size_t>(i)].first)]);
  }
  return tracked;
}

LabelledTextures Label(const TrackedImage& image, const TrackedImage& next, const SequenceImageOptions& images,
                       const TrackLabelOptions& options) {
  const std::vector<cv::Point2f> tracked = TrackedPoints(image, next, options.tracker);
  const double needed_in_image = options.rough_tracks;
  const double needed_in_block = needed_in_image / (images.grid.columns * images.grid.rows);
  LabelledTextures labelled;
  for (const TextureBlock& block : image.blocks) {
    const auto inside = std::count_if(tracked.begin(), tracked.end(),
                                      [&](const cv::Point2f& point) { return block.area.contains(point); });
    const bool rough = options.by_block ? static_cast<double>(inside) >= needed_in_block
                                        : static_cast<double>(tracked.size()) >= needed_in_image;
    labelled[rough ? kRough : kSmooth].push_back(block.features);
  }
  return labelled;
}

}  // namespace

void Append(const LabelledTextures& blocks, LabelledTextures* to) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    (*to)[i].insert((*to)[i].end(), blocks[i].begin(), blocks[i].end());
  }
}

void TrackLabelOptions::Check() const {
  RequireOption(rough_tracks >= 1, "rough_tracks must be at least 1");
  RequireOption(fast_threshold >= 1 && fast_threshold <= 254, "fast_threshold must be 1 to 254");
  RequireOption(max_points >= 1, "max_points must be at least 1");
  tracker.Check();
}

void SequenceImageOptions::Check() const {
  grid.Check();
  RequireOption(width_px >= 64, "width_px must be at least 64");
}

cv::Mat ReducedGray(const cv::Mat& picture, int width_px) {
  cv::Mat gray;
  cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
  if (gray.cols > width_px) {
    const int height_px = std::max(1, cvRound(static_cast<double>(gray.rows) * width_px / gray.cols));
    cv::resize(gray, gray, {width_px, height_px}, 0, 0, cv::INTER_AREA);
  }
  return gray;
}

std::vector<LabelledTextures> LabelByTracks(const std::vector<std::filesystem::path>& sequence,
                                            const SequenceImageOptions& images, const TrackLabelOptions& options) {
  images.Check();
  options.Check();
  std::vector<LabelledTextures> pairs;
  TrackedImage image;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    TrackedImage next = ReadTracked(sequence[i], images, options);
    if (i > 0 && next.points.size_px != image.points.size_px) {
      throw InputError(sequence[i], "has another size than the image before; give images of one camera");
    }
    if (i > 0) {
      pairs.push_back(Label(image, next, images, options));
    }
    image = std::move(next);
  }
  return pairs;
}

}  // namespace floorloc
