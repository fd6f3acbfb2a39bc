// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "mapbuilder/surface/track_labels.h"

namespace floorloc {

/// Blocks to train with, and others to test with.
struct TextureSamples {
  LabelledTextures training;
  LabelledTextures testing;
};

struct TextureSampleOptions {
  /// Labelled images of this width or more are whole images, which are divided into blocks; narrower ones are a block.
  SequenceImageOptions images;
  TrackLabelOptions tracks;  ///< where there are no labels
  double test_share = 0.3;   ///< Otsu et al. (2013), table 3: 18 % of Urasabaku's blocks, 20 % of Sunasenri's
  std::uint32_t seed = 1;    ///< which labelled images are kept for testing
  int min_class_blocks = 4;  ///< of each class; fewer leave nothing to train or to test with

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Blocks of a folder with a subfolder of images for each of the classes rough, smooth and, if there is any, shadow
/// (in any case); or of image sequences, labelled by their tracks: the folder's own images or those of its images/, in
/// the order of their numbers, else one sequence per subfolder. Blocks of one image, and of a tenth of the sequences'
/// pairs in a row, are kept together. Throws InputError with what is missing.
TextureSamples ReadTextureSamples(const std::filesystem::path& folder, const TextureSampleOptions& options = {});

}  // namespace floorloc
