// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "core/surface/texture/texture_classifier.h"
#include "tests/bench/common/extractor_tally.h"
#include "tests/bench/scenes/scene.h"

namespace floorloc {

/// The texture of each frame, by the name of its group, in the order in which the frames are tallied.
using TexturesByGroup = std::map<std::string, std::vector<TextureClass>>;

/// Adds the scene's frames, rectified and reduced to the width of the article's images, 320 pixels.
void AssessFrames(const Scene& scene, const TextureClassifier& classifier, TexturesByGroup* textures);

/// Prints for each group, over the whole map: what each extractor finds alone in what time, what each pair finds of
/// which the frame's texture chooses one (the first on ROUGH), and what at least one of two finds: no choice is better.
/// Pairs of which the second one is not slower are left out.
void PrintChoices(std::ostream& out, const std::vector<ExtractorTally>& tallies, const TexturesByGroup& textures);

}  // namespace floorloc
