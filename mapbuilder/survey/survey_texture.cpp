// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/survey_texture.h"

#include <algorithm>

#include "core/surface/texture/floor_model.h"

namespace floorloc {
namespace {

constexpr std::size_t kBlocksPerFrame = 16;

void AddSamples(const cv::Mat& samples, std::vector<BlockTexture>* blocks) {
  for (int row = 0; row < samples.rows; ++row) {
    blocks->emplace_back(Eigen::Map<const BlockTexture>(samples.ptr<double>(row)));
  }
}

}  // namespace

cv::Mat SampleBlockTextures(const GroundImage& image) {
  std::vector<FloorBlock> blocks = MeasureFloorBlocks(image);
  std::erase_if(blocks, [](const FloorBlock& block) { return block.blank; });
  const std::size_t step = std::max<std::size_t>(1, blocks.size() / kBlocksPerFrame);
  cv::Mat samples(0, BlockTexture::SizeAtCompileTime, CV_64FC1);
  for (std::size_t i = 0; i < blocks.size(); i += step) {
    samples.push_back(cv::Mat(1, BlockTexture::SizeAtCompileTime, CV_64FC1, blocks[i].texture.data()));
  }
  return samples;
}

std::vector<MapFloorTexture> FloorTexturesOf(const FrameSet& set) {
  std::vector<std::vector<BlockTexture>> blocks(set.surveys.size());
  for (const BuildFrame& frame : set.frames) {
    AddSamples(frame.texture, &blocks[static_cast<std::size_t>(frame.survey)]);
  }
  std::vector<MapFloorTexture> textures;
  for (std::vector<BlockTexture>& of_survey : blocks) {
    const std::optional<FloorTextureModel> model = LearnFloorTexture(std::move(of_survey));
    textures.push_back(model ? MapFloorTexture{model->blocks, model->mean, model->covariance} : MapFloorTexture{});
  }
  return textures;
}

}  // namespace floorloc
