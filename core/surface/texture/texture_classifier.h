// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "core/surface/texture/adaboost.h"
#include "core/surface/texture/texture_features.h"

namespace floorloc {

/// Terrain classes of Otsu et al. (2013), section 3.1.
enum class TextureClass {
  kUnknown,  ///< no classifier claims it
  kRough,    ///< many keypoints, easily tracked
  kSmooth,   ///< few keypoints: a sensitive detector is needed
  kShadow,   ///< the robot's own shadow: it moves with the camera
};
constexpr std::array<TextureClass, 3> kTextureClasses = {TextureClass::kRough, TextureClass::kSmooth,
                                                         TextureClass::kShadow};
/// "UNKNOWN", "ROUGH", "SMOOTH", "SHADOW"
const char* ToString(TextureClass texture);

/// One against all for each class, combined as argmax of (1 - error) H over the classes with H > 0. The article prints
/// H as a sign, of which no maximum could be taken: the vote's value (StrongClassifier::Score) is. Of the two errors
/// that it names (3.1: training, 5.1: generalisation) that of generalisation is taken, where it was measured.
struct TextureClassifier {
  TextureGrid grid;
  /// As kTextureClasses; empty for a class that no sample has: there is no shadow under a cloudy sky.
  std::array<std::optional<StrongClassifier>, kTextureClasses.size()> classes;

  TextureClass Classify(const TextureFeatures& features) const;
};

struct TextureAssessment {
  std::vector<TextureBlock> blocks;
  std::vector<TextureClass> classes;  ///< of the blocks
  /// The blocks' vote: ROUGH or SMOOTH, by more of them; SHADOW and UNKNOWN do not vote.
  TextureClass texture = TextureClass::kUnknown;

  /// CV_8UC1 of the image's size, 255 but for the blocks in shadow: where features are looked for.
  cv::Mat WithoutShadow(cv::Size image_px) const;
};

/// gray: CV_8UC1 with at least a pixel for each block.
TextureAssessment AssessTexture(const cv::Mat& gray, const TextureClassifier& classifier);

}  // namespace floorloc
