// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "core/surface/texture/texture_classifier.h"

namespace floorloc {

/// What `classify` says of an image by its texture.
struct TextureResult {
  std::string line;        ///< JSON
  cv::Mat class_of_block;  ///< CV_32SC1: index in kTextureClasses of each block; -1: unknown, or left out
};

/// The class of an image is the vote of its blocks, or shadow where more of them are in shadow; its score their share.
/// As in training, images narrower than 320 pixels are one block, and wider ones are reduced to that width. picture:
/// CV_8UC3.
TextureResult ClassifyTexture(const cv::Mat& picture, const std::string& filename, const TextureClassifier& classifier);

}  // namespace floorloc
