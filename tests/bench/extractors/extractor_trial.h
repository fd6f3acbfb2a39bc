// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "tests/bench/common/extractor_tally.h"
#include "tests/bench/extractors/extractor_variant.h"
#include "tests/bench/scenes/scene.h"

namespace floorloc {

/// Builds the scene's map with the extractor at map_file (replaced), localizes all frames in it with and without their
/// prior on all cores, and adds the results to the tally. Throws the builder's exceptions, and std::invalid_argument
/// when the ground truth covers fewer than two of the map's frames.
void TryExtractor(const ExtractorVariant& variant, const Scene& scene, const std::filesystem::path& map_file,
                  ExtractorTally* tally);

}  // namespace floorloc
