// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/classify_texture.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mapbuilder/surface/track_labels.h"

namespace floorloc {
namespace {

// As the folders of train-surface --texture.
std::string FolderName(TextureClass texture) {
  std::string name = ToString(texture);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

TextureClass ClassOfImage(const TextureAssessment& assessment) {
  const auto count = [&](TextureClass texture) {
    return std::count(assessment.classes.begin(), assessment.classes.end(), texture);
  };
  const bool dark = count(TextureClass::kShadow) > std::max(count(TextureClass::kRough), count(TextureClass::kSmooth));
  return dark ? TextureClass::kShadow : assessment.texture;
}

int LabelOf(TextureClass texture) {
  const auto* found = std::find(kTextureClasses.begin(), kTextureClasses.end(), texture);
  return found == kTextureClasses.end() ? -1 : static_cast<int>(found - kTextureClasses.begin());
}

cv::Rect Enlarged(const cv::Rect& area, double factor) {
  return {cv::Point(cvRound(factor * area.x), cvRound(factor * area.y)),
          cv::Point(cvRound(factor * area.br().x), cvRound(factor * area.br().y))};
}

}  // namespace

TextureResult ClassifyTexture(const cv::Mat& picture, const std::string& filename,
                              const TextureClassifier& classifier) {
  const SequenceImageOptions options;
  const cv::Mat gray = ReducedGray(picture, options.width_px);
  TextureClassifier of_image = classifier;
  if (gray.cols < options.width_px || gray.rows < classifier.grid.rows) {
    of_image.grid = {1, 1, 0};
  }
  const TextureAssessment assessment = AssessTexture(gray, of_image);
  const TextureClass texture = ClassOfImage(assessment);
  const auto blocks = static_cast<double>(assessment.blocks.size());
  const TextureGrid& grid = of_image.grid;
  TextureResult result{{}, cv::Mat(grid.rows, grid.columns, CV_32SC1, cv::Scalar(-1))};
  nlohmann::ordered_json segments = nlohmann::json::array();
  for (std::size_t i = 0; i < assessment.blocks.size(); ++i) {
    const cv::Rect area = Enlarged(assessment.blocks[i].area, static_cast<double>(picture.cols) / gray.cols);
    segments.push_back(
        {{"class", FolderName(assessment.classes[i])}, {"box", {area.x, area.y, area.width, area.height}}});
    const int block = static_cast<int>(i) + grid.skipped_rows * grid.columns;
    result.class_of_block.at<int>(block / grid.columns, block % grid.columns) = LabelOf(assessment.classes[i]);
  }
  const auto alike = std::count(assessment.classes.begin(), assessment.classes.end(), texture);
  const nlohmann::ordered_json line{{"filename", filename},
                                    {"class", FolderName(texture)},
                                    {"score", std::round(1e4 * static_cast<double>(alike) / blocks) / 1e4},
                                    {"segments", segments}};
  result.line = line.dump() + "\n";
  return result;
}

}  // namespace floorloc
