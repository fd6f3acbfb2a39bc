// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/texture_samples.h"

#include <algorithm>
#include <cctype>
#include <random>
#include <string>

#include "core/geometry/option_check.h"
#include "core/io/floor_picture.h"
#include "core/io/image_folder.h"
#include "core/io/input_error.h"
#include "mapbuilder/surface/picture_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

std::string InUpperCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

using ClassFolders = std::array<fs::path, kTextureClasses.size()>;

// Empty paths: there is none.
ClassFolders FindClassFolders(const fs::path& folder) {
  ClassFolders found;
  for (const fs::path& entry : SortedEntries(folder)) {
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (fs::is_directory(entry) && InUpperCase(entry.filename().string()) == ToString(kTextureClasses[i])) {
        found[i] = entry;
      }
    }
  }
  return found;
}

template <typename Value>
void Shuffle(std::mt19937* random, std::vector<Value>* values) {
  for (std::size_t k = values->size(); k > 1; --k) {
    std::swap((*values)[k - 1], (*values)[(*random)() % k]);  // not std::shuffle: the same on every system
  }
}

// How many of `count` are kept for testing: at least one, not all.
std::size_t TestCount(std::size_t count, double share) {
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(count));
  return std::clamp<std::size_t>(wanted, count < 2 ? 0 : 1, count < 2 ? 0 : count - 1);
}

std::vector<TextureFeatures> MeasureLabelled(const fs::path& file, const SequenceImageOptions& options) {
  const cv::Mat gray = ReducedGray(ReadPictureOfAnySize(file), options.width_px);
  std::vector<TextureFeatures> blocks;
  if (gray.cols < options.width_px || gray.rows < options.grid.rows) {
    blocks.push_back(MeasureTexture(gray));
    return blocks;
  }
  for (const TextureBlock& block : MeasureTextureBlocks(gray, options.grid)) {
    blocks.push_back(block.features);
  }
  return blocks;
}

TextureSamples ReadLabelled(const fs::path& folder, const ClassFolders& class_folders,
                            const TextureSampleOptions& options) {
  std::mt19937 random(options.seed);
  TextureSamples samples;
  for (std::size_t i = 0; i < class_folders.size(); ++i) {
    if (class_folders[i].empty() && kTextureClasses[i] == TextureClass::kShadow) {
      continue;
    }
    if (class_folders[i].empty()) {
      throw InputError(folder, std::string("has no images of class ") + ToString(kTextureClasses[i]) +
                                   "; put some into a subfolder of that name");
    }
    std::vector<fs::path> files = ListPictures(class_folders[i]).pictures;
    if (files.size() < 2) {
      throw InputError(class_folders[i], "has one image only; give at least two, of which one is kept for testing");
    }
    Shuffle(&random, &files);
    const std::size_t testing = TestCount(files.size(), options.test_share);
    for (std::size_t k = 0; k < files.size(); ++k) {
      const std::vector<TextureFeatures> blocks = MeasureLabelled(files[k], options.images);
      std::vector<TextureFeatures>& to = (k < testing ? samples.testing : samples.training)[i];
      to.insert(to.end(), blocks.begin(), blocks.end());
    }
  }
  return samples;
}

std::vector<std::vector<fs::path>> ListSequences(const fs::path& folder) {
  if (fs::is_directory(folder / "images") || !ImageFilesIn(folder).empty()) {
    return {ListPictures(folder).pictures};
  }
  std::vector<std::vector<fs::path>> sequences;
  for (const fs::path& entry : SortedEntries(folder)) {
    if (fs::is_directory(entry) && (fs::is_directory(entry / "images") || !ImageFilesIn(entry).empty())) {
      sequences.push_back(ListPictures(entry).pictures);
    }
  }
  return sequences;
}

// Of ten runs of pairs those that make up the share for testing, evenly.
TextureSamples SplitRuns(const std::vector<LabelledTextures>& pairs, double test_share) {
  const std::size_t runs = std::min<std::size_t>(10, pairs.size());
  TextureSamples samples;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::size_t index = i * runs / pairs.size();
    const auto run = static_cast<double>(index);
    const bool testing = static_cast<int>((run + 1.0) * test_share) > static_cast<int>(run * test_share);
    Append(pairs[i], testing ? &samples.testing : &samples.training);
  }
  return samples;
}

bool LacksAClass(const TextureSamples& samples) {
  for (std::size_t i = 0; i < samples.training.size(); ++i) {
    if (samples.training[i].empty() != samples.testing[i].empty()) {
      return true;
    }
  }
  return false;
}

TextureSamples SplitBlocks(const TextureSamples& together, const TextureSampleOptions& options) {
  std::mt19937 random(options.seed);
  LabelledTextures all = together.training;
  Append(together.testing, &all);
  TextureSamples samples;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Shuffle(&random, &all[i]);
    const auto middle = all[i].begin() + static_cast<std::ptrdiff_t>(TestCount(all[i].size(), options.test_share));
    samples.testing[i].assign(all[i].begin(), middle);
    samples.training[i].assign(middle, all[i].end());
  }
  return samples;
}

TextureSamples ReadSequences(const fs::path& folder, const TextureSampleOptions& options) {
  std::vector<LabelledTextures> pairs;
  for (const std::vector<fs::path>& sequence : ListSequences(folder)) {
    const std::vector<LabelledTextures> of_sequence = LabelByTracks(sequence, options.images, options.tracks);
    pairs.insert(pairs.end(), of_sequence.begin(), of_sequence.end());
  }
  if (pairs.empty()) {
    throw InputError(folder,
                     "has neither subfolders rough and smooth with images of these, nor two images in a row; give one "
                     "or the other");
  }
  const TextureSamples samples = SplitRuns(pairs, options.test_share);
  // Where one kind of floor lies in few runs.
  return LacksAClass(samples) ? SplitBlocks(samples, options) : samples;
}

void RequireBlocks(const fs::path& folder, const TextureSamples& samples, bool labelled,
                   const TextureSampleOptions& options) {
  for (std::size_t i = 0; i < samples.training.size(); ++i) {
    const std::size_t blocks = samples.training[i].size() + samples.testing[i].size();
    const bool absent = kTextureClasses[i] == TextureClass::kShadow && blocks == 0;
    if (!absent && blocks < static_cast<std::size_t>(options.min_class_blocks)) {
      throw InputError(
          folder, "only " + std::to_string(blocks) + " blocks are " + ToString(kTextureClasses[i]) + "; " +
                      (labelled ? std::string("give more images of that class, for ") +
                                      std::to_string(options.min_class_blocks) + " blocks at least"
                                : "by their tracks: give sequences over both kinds of floor, or images in subfolders "
                                  "rough and smooth, or another --tracks"));
    }
  }
}

}  // namespace

void TextureSampleOptions::Check() const {
  images.Check();
  tracks.Check();
  RequireOption(test_share > 0.0 && test_share < 1.0, "test_share must be above 0 and below 1");
  RequireOption(min_class_blocks >= 2, "min_class_blocks must be at least 2");
}

TextureSamples ReadTextureSamples(const fs::path& folder, const TextureSampleOptions& options) {
  options.Check();
  const ClassFolders class_folders = FindClassFolders(folder);
  const bool labelled = std::any_of(class_folders.begin(), class_folders.end(),
                                    [](const fs::path& of_class) { return !of_class.empty(); });
  TextureSamples samples = labelled ? ReadLabelled(folder, class_folders, options) : ReadSequences(folder, options);
  RequireBlocks(folder, samples, labelled, options);
  return samples;
}

}  // namespace floorloc
