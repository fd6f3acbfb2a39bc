// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/texture_classifier.h"

#include <algorithm>

namespace floorloc {

const char* ToString(TextureClass texture) {
  switch (texture) {
    case TextureClass::kUnknown:
      return "UNKNOWN";
    case TextureClass::kRough:
      return "ROUGH";
    case TextureClass::kSmooth:
      return "SMOOTH";
    case TextureClass::kShadow:
      return "SHADOW";
  }
  return "UNKNOWN";
}

TextureClass TextureClassifier::Classify(const TextureFeatures& features) const {
  TextureClass best = TextureClass::kUnknown;
  double best_vote = 0.0;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const double vote = classes[i] ? (1.0 - classes[i]->error) * classes[i]->Score(features) : 0.0;
    if (vote > best_vote) {
      best = kTextureClasses[i];
      best_vote = vote;
    }
  }
  return best;
}

cv::Mat TextureAssessment::WithoutShadow(cv::Size image_px) const {
  cv::Mat mask(image_px, CV_8UC1, cv::Scalar(255));
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (classes[i] == TextureClass::kShadow) {
      mask(blocks[i].area).setTo(0);
    }
  }
  return mask;
}

TextureAssessment AssessTexture(const cv::Mat& gray, const TextureClassifier& classifier) {
  TextureAssessment assessment;
  assessment.blocks = MeasureTextureBlocks(gray, classifier.grid);
  for (const TextureBlock& block : assessment.blocks) {
    assessment.classes.push_back(classifier.Classify(block.features));
  }
  const auto votes = [&](TextureClass texture) {
    return std::count(assessment.classes.begin(), assessment.classes.end(), texture);
  };
  const auto rough = votes(TextureClass::kRough);
  const auto smooth = votes(TextureClass::kSmooth);
  if (rough != smooth) {
    assessment.texture = rough > smooth ? TextureClass::kRough : TextureClass::kSmooth;
  }
  return assessment;
}

}  // namespace floorloc
