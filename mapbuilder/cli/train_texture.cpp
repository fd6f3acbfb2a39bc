// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/train_texture.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/io/text_file.h"
#include "core/surface/texture/texture_model_file.h"

namespace floorloc {
namespace {

nlohmann::ordered_json ToJson(const TextureTraining& training) {
  nlohmann::ordered_json json{{"right", training.accuracy}, {"classes", nlohmann::json::array()}};
  for (const TextureClassReport& report : training.classes) {
    const auto row = static_cast<std::size_t>(
        std::find(kTextureClasses.begin(), kTextureClasses.end(), report.texture) - kTextureClasses.begin());
    json["classes"].push_back({{"class", ToString(report.texture)},
                               {"training_blocks", report.training},
                               {"testing_blocks", report.testing},
                               {"classifiers", report.classifiers},
                               {"training_error", report.training_error},
                               {"test_error", report.test_error},
                               {"taken_as_rough_smooth_shadow_unknown", training.confusion[row]},
                               {"training_curve", report.training_curve},
                               {"test_curve", report.test_curve}});
  }
  return json;
}

}  // namespace

void AddTextureOptions(CLI::App* command, CLI::App* sources, TextureArguments* arguments) {
  TextureArguments& a = *arguments;
  CLI::Option* texture = sources->add_option(
      "--texture", a.folder,
      "Rough or smooth floor: folder with folders rough, smooth and shadow of images, or of image sequences, which are "
      "labelled by how many points are tracked from one image to the next");
  command->add_flag("--skip-upper-row", a.skip_upper_row, "Of the 3 rows of blocks, for cameras that see far")
      ->needs(texture);
  command->add_option("--tracks", a.samples.tracks.rough_tracks, "Sequences: tracks of a pair of images that is rough")
      ->needs(texture)
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command
      ->add_option("--fast-threshold", a.samples.tracks.fast_threshold, "Sequences: of FAST, whose points are tracked")
      ->needs(texture)
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  command
      ->add_flag("--label-images", a.label_images, "Sequences: label images as a whole, not each block by its tracks")
      ->needs(texture);
  command->add_option("--image-width", a.samples.images.width_px, "Larger images are reduced to that width, pixels")
      ->needs(texture)
      ->check(CLI::Range(64, 10'000))
      ->capture_default_str();
  command->add_option("--classifiers", a.training.max_classifiers, "Most weak classifiers of a class")
      ->needs(texture)
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

void TrainTextureModel(TextureArguments a) {
  a.training.grid.skipped_rows = a.skip_upper_row ? 1 : 0;
  a.samples.images.grid = a.training.grid;
  a.samples.tracks.by_block = !a.label_images;
  CheckWritable(a.out);
  const TextureSamples samples = ReadTextureSamples(a.folder, a.samples);
  const TextureTraining training = TrainTextures(samples, a.training);
  WriteFileAtomically(a.out, FormatTextureModel(training.classifier));
  std::cout << (a.json ? ToJson(training).dump(2) + "\n" : FormatTraining(training));
}

}  // namespace floorloc
