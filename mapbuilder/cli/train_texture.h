// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "mapbuilder/surface/texture_samples.h"
#include "mapbuilder/surface/texture_training.h"

namespace floorloc {

/// `train-surface --texture`.
struct TextureArguments {
  std::filesystem::path folder;
  std::filesystem::path out;
  bool skip_upper_row = false;
  bool label_images = false;
  bool json = false;
  TextureSampleOptions samples;
  TextureTrainingOptions training;
};

/// Adds --texture to the sources, a group of the command, and to the command the options that go with it alone. The
/// arguments must outlive the command.
void AddTextureOptions(CLI::App* command, CLI::App* sources, TextureArguments* arguments);

/// Trains, writes the model and prints the tables. Throws InputError.
void TrainTextureModel(TextureArguments arguments);

}  // namespace floorloc
