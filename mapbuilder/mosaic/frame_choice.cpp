// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/frame_choice.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

// Sorted best first; the last entry is the best candidate that is not chosen.
struct Ranking {
  struct Entry {
    int candidate = -1;
    float weight = 0.0F;
  };
  std::array<Entry, NodeChoice::kFrames + 1> entries;
  float depth_px = 0.0F;

  void Insert(Entry entry) {
    for (Entry& other : entries) {
      if (entry.weight > other.weight) {
        std::swap(entry, other);
      }
    }
  }
};

// Border cells are only partly in view: their weight is almost zero wherever another frame covers the floor.
float WeightOf(float depth_px, float border_px) {
  return std::max(0.0F, depth_px - border_px) + 0.01F * std::min(depth_px, border_px);
}

NodeChoice Share(const Ranking& ranking) {
  NodeChoice choice;
  choice.depth_px = ranking.depth_px;
  // Subtracts the weight of the best frame not chosen, so that frames enter and leave the choice with weight zero.
  const float left_out = ranking.entries.back().weight;
  float detail_sum = 0.0F;
  float light_sum = 0.0F;
  for (std::size_t i = 0; i < choice.chosen.size(); ++i) {
    const Ranking::Entry& entry = ranking.entries[i];
    const float weight = i == 0 ? std::max(entry.weight - left_out, 1e-3F) : entry.weight - left_out;
    if (entry.candidate < 0 || weight <= 0.0F) {
      break;
    }
    choice.chosen[i] = {entry.candidate, weight * weight * weight, weight};
    detail_sum += choice.chosen[i].high_band_weight;
    light_sum += choice.chosen[i].low_band_weight;
  }
  for (NodeChoice::Chosen& chosen : choice.chosen) {
    chosen.high_band_weight /= std::max(detail_sum, 1e-12F);
    chosen.low_band_weight /= std::max(light_sum, 1e-12F);
  }
  return choice;
}

}  // namespace

NodeChoice::Chosen NodeChoice::Of(int candidate) const {
  const auto* it =
      std::find_if(chosen.begin(), chosen.end(), [&](const Chosen& c) { return c.candidate == candidate; });
  return it == chosen.end() ? Chosen() : *it;
}

NodeChoices ChooseFrames(const MosaicGrid& grid, const std::vector<FrameView>& candidates) {
  const auto columns = static_cast<std::size_t>(grid.nodes());
  std::vector<Ranking> rankings(columns * columns);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const FrameView& view = candidates[c];
    const cv::Rect footprint = view.Footprint(grid);
    for (int row = footprint.y; row < footprint.y + footprint.height; ++row) {
      for (int column = footprint.x; column < footprint.x + footprint.width; ++column) {
        const float depth_px = view.Depth(grid.MapFromNode(column, row));
        if (depth_px > 0.0F) {
          Ranking& ranking = rankings[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
          ranking.Insert({static_cast<int>(c), WeightOf(depth_px, view.BorderPx(grid))});
          ranking.depth_px = std::max(ranking.depth_px, depth_px);
        }
      }
    }
  }
  NodeChoices choices(rankings.size());
  std::transform(rankings.begin(), rankings.end(), choices.begin(), Share);
  return choices;
}

}  // namespace floorloc
