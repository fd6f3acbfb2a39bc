// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/picture_features.h"

#include <algorithm>
#include <random>
#include <utility>

#include "core/surface/classes/surface_classifier.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

Segmentation WholePicture(cv::Size size) { return {cv::Mat::zeros(size, CV_32SC1), 1}; }

// So many segments, drawn without replacement.
void DrawSegments(std::vector<SegmentFeatures> segments, int count, std::mt19937_64* random,
                  std::vector<SegmentFeatures>* drawn) {
  for (int i = 0; i < count && !segments.empty(); ++i) {
    const std::size_t chosen = (*random)() % segments.size();
    drawn->push_back(std::move(segments[chosen]));
    segments.erase(segments.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
}

std::vector<float> LookOf(const SurfaceImage& image) {
  FeatureOptions options;
  options.groups = {FeatureGroup::kHueSaturation, FeatureGroup::kValue};
  const SegmentFeatures whole = ExtractFeatures(image, WholePicture(image.color.size()), options).front();
  std::vector<float> look;
  for (const FeatureGroup group : options.groups) {
    look.insert(look.end(), whole.Of(group).begin(), whole.Of(group).end());
  }
  return look;
}

PictureFeatures Measure(const SurfaceImage& image, const PictureFeatureOptions& options, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  PictureFeatures measured;
  measured.training = ExtractFeatures(image, WholePicture(image.color.size()), options.features);
  DrawSegments(ExtractFeatures(image, SegmentImage(image.color, options.training), options.features),
               options.segments_per_picture, &random, &measured.training);
  measured.segments = ExtractFeatures(image, SegmentImage(image.color, options.classification), options.features);
  measured.look = LookOf(image);
  return measured;
}

struct Place {
  int label;
  std::size_t picture;
};

std::vector<Place> AllPictures(const LabelledFolder& folder) {
  std::vector<Place> places;
  for (std::size_t c = 0; c < folder.folders.size(); ++c) {
    for (std::size_t i = 0; i < folder.folders[c].pictures.size(); ++i) {
      places.push_back({static_cast<int>(c), i});
    }
  }
  return places;
}

}  // namespace

std::vector<PictureFeatures> MeasurePictures(const LabelledFolder& folder, const PictureFeatureOptions& options) {
  const std::vector<Place> places = AllPictures(folder);
  std::vector<PictureFeatures> measured(places.size());
  ProgressBar progress("measuring pictures", static_cast<std::int64_t>(places.size()), options.run.progress);
  ParallelFor(static_cast<int>(places.size()), options.run.threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    const PictureFolder& pictures = folder.folders[static_cast<std::size_t>(places[at].label)];
    const SurfaceImage image =
        ReduceImage(ReadPicture(pictures, pictures.pictures[places[at].picture]), options.max_side_px);
    measured[at] = Measure(image, options, options.seed + at);
    measured[at].label = places[at].label;
    progress.Advance();
  });
  return measured;
}

float UsualMaxIntensity(const LabelledFolder& folder) {
  if (!folder.has_range()) {
    return 1.0F;
  }
  std::vector<std::int64_t> counts(65536, 0);
  std::int64_t total = 0;
  for (const PictureFolder& pictures : folder.folders) {
    for (const std::filesystem::path& picture : pictures.pictures) {
      const SurfaceImage image = ReadPicture(pictures, picture);
      for (int y = 0; y < image.depth_mm.rows; ++y) {
        for (int x = 0; x < image.depth_mm.cols; ++x) {
          if (image.depth_mm.at<std::uint16_t>(y, x) > 0) {
            ++counts[image.intensity.at<std::uint16_t>(y, x)];
            ++total;
          }
        }
      }
    }
  }
  std::int64_t below = 0;
  int value = 0;
  while (value < 65535 && (below += counts[static_cast<std::size_t>(value)]) * 100 < total * 99) {
    ++value;
  }
  return static_cast<float>(value + 1);
}

}  // namespace floorloc
