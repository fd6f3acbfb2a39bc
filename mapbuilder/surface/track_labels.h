// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "core/surface/texture/texture_classifier.h"
#include "mapbuilder/surface/patch_tracker.h"

namespace floorloc {

/// Blocks by their class, in the order of kTextureClasses.
using LabelledTextures = std::array<std::vector<TextureFeatures>, kTextureClasses.size()>;

/// Adds the blocks of the second to the first.
void Append(const LabelledTextures& blocks, LabelledTextures* to);

/// Labels by the criterion of Otsu et al. (2013), section 3.1: a pair of images with 30 successful tracks is ROUGH.
struct TrackLabelOptions {
  int rough_tracks = 30;
  /// Each block by its share of these tracks, so that images that show both kinds of floor are of use; otherwise all
  /// blocks of an image alike, as the article says.
  bool by_block = true;
  int fast_threshold = 20;  ///< of FAST, whose points are tracked: ROUGH is where the fast detector is enough
  int max_points = 2000;    ///< of an image, the strongest
  PatchTrackerOptions tracker;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// How the images of a sequence are read.
struct SequenceImageOptions {
  TextureGrid grid;
  int width_px = 320;  ///< larger images are reduced to this width, the article's

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// The picture (CV_8UC3) as CV_8UC1, reduced to the width if it is wider.
cv::Mat ReducedGray(const cv::Mat& picture, int width_px);

/// Labels the blocks of each image but the last by the tracks into the next one; one element per pair. Throws
/// InputError when an image cannot be read, or has another size than the one before.
std::vector<LabelledTextures> LabelByTracks(const std::vector<std::filesystem::path>& sequence,
                                            const SequenceImageOptions& images = {},
                                            const TrackLabelOptions& options = {});

}  // namespace floorloc
