// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/surface/texture/texture_classifier.h"

namespace floorloc {

/// The model as text: a title with the version, the grid, then each class with its error and a line per weak classifier
/// (four weights, sign, reliability).
std::string FormatTextureModel(const TextureClassifier& classifier);

/// Reads it back exactly. Throws std::invalid_argument with the line and what is wrong with it.
TextureClassifier ParseTextureModel(const std::string& text);

}  // namespace floorloc
