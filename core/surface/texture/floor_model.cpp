// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/floor_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

FloorTextureModel Fit(const std::vector<BlockTexture>& blocks, std::size_t count) {
  FloorTextureModel model;
  model.blocks = static_cast<int>(count);
  for (std::size_t i = 0; i < count; ++i) {
    model.mean += blocks[i];
  }
  model.mean /= static_cast<double>(count);
  model.covariance.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const BlockTexture off = blocks[i] - model.mean;
    model.covariance += off * off.transpose();
  }
  model.covariance /= static_cast<double>(count);
  return model;
}

// The blocks that the model fits best come first.
void PutTypicalFirst(const FloorTextureModel& model, std::size_t count, std::vector<BlockTexture>* blocks) {
  const Eigen::LLT<BlockTextureCovariance> covariance(model.covariance);
  std::vector<std::pair<double, std::size_t>> distances;
  for (std::size_t i = 0; i < blocks->size(); ++i) {
    distances.emplace_back(covariance.matrixL().solve((*blocks)[i] - model.mean).squaredNorm(), i);
  }
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(count - 1), distances.end());
  std::vector<BlockTexture> ordered;
  for (const auto& [distance, i] : distances) {
    ordered.push_back((*blocks)[i]);
  }
  *blocks = std::move(ordered);
}

bool IsUsable(const FloorTextureModel& model) {
  return model.mean.allFinite() && model.covariance.allFinite() && model.covariance.llt().info() == Eigen::Success &&
         model.covariance.diagonal().minCoeff() > 0.0;
}

}  // namespace

void FloorModelOptions::Check() const {
  RequireOption(min_blocks >= 10, "min_blocks must be at least 10");
  RequireOption(kept_share > 0.5 && kept_share <= 1.0, "kept_share must be above 0.5 and at most 1");
  RequireOption(passes >= 0, "passes must not be negative");
}

std::optional<FloorTextureModel> LearnFloorTexture(std::vector<BlockTexture> blocks, const FloorModelOptions& options) {
  options.Check();
  if (blocks.size() < static_cast<std::size_t>(options.min_blocks)) {
    return std::nullopt;
  }
  const auto kept = static_cast<std::size_t>(options.kept_share * static_cast<double>(blocks.size()));
  FloorTextureModel model = Fit(blocks, blocks.size());
  for (int pass = 0; pass < options.passes && IsUsable(model); ++pass) {
    PutTypicalFirst(model, kept, &blocks);
    model = Fit(blocks, kept);
  }
  return IsUsable(model) ? std::optional(model) : std::nullopt;
}

}  // namespace floorloc
