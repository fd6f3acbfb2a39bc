// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/keypoints/pruning_rule.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core.hpp>
#include <random>
#include <unordered_map>

#include "mapbuilder/coverage/cell_key.h"

namespace floorloc {
namespace {

MapKeypoints Select(const MapKeypoints& all, const std::vector<int>& chosen) {
  MapKeypoints selected;
  for (const int i : chosen) {
    const auto index = static_cast<std::size_t>(i);
    selected.keypoints.push_back(all.keypoints[index]);
    selected.observations.push_back(all.observations[index]);
    selected.distinctiveness.push_back(all.distinctiveness[index]);
    selected.last_survey.push_back(all.last_survey[index]);
    selected.descriptors.push_back(all.descriptors.row(i));
  }
  return selected;
}

std::vector<int> ChooseMostObserved(const MapKeypoints& all, const PruningOptions& options) {
  const auto limit = static_cast<int>(std::max(1.0, options.max_per_m2 * options.cell_m * options.cell_m));
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    const auto x = static_cast<std::size_t>(a);
    const auto y = static_cast<std::size_t>(b);
    return all.observations[x] != all.observations[y] ? all.observations[x] > all.observations[y]
                                                      : all.keypoints[x].response > all.keypoints[y].response;
  });
  std::unordered_map<std::int64_t, int> used;
  std::vector<int> chosen;
  for (const int i : order) {
    if (used[CellKey(all.keypoints[static_cast<std::size_t>(i)].Position(), options.cell_m)]++ < limit) {
      chosen.push_back(i);
    }
  }
  return chosen;
}

std::vector<int> ChooseAny(const MapKeypoints& all, const KeypointFusionInput& input, const PruningOptions& options) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Eigen::Vector2d> positions;
  std::vector<double> usefulness;
  for (const Keypoint& k : all.keypoints) {
    positions.push_back(k.Position());
    usefulness.push_back(unit(random));
  }
  return ChooseEvenly(positions, usefulness, CoverageGrid(input.map_from_base, input.floor_in_base), options);
}

}  // namespace

const char* ToString(PruningRule rule) {
  switch (rule) {
    case PruningRule::kUseful:
      return "useful";
    case PruningRule::kObserved:
      return "observed";
    case PruningRule::kRandom:
      return "random";
  }
  return "unknown";
}

const std::vector<PruningRule>& AllPruningRules() {
  static const std::vector<PruningRule> rules{PruningRule::kUseful, PruningRule::kObserved, PruningRule::kRandom};
  return rules;
}

MapKeypoints FuseByRule(PruningRule rule, const KeypointFusionInput& input, const KeypointFusionOptions& options) {
  if (rule == PruningRule::kUseful) {
    return FuseKeypoints(input, options);
  }
  KeypointFusionOptions unlimited = options;
  unlimited.pruning.max_per_m2 = HUGE_VAL;
  const MapKeypoints all = FuseKeypoints(input, unlimited);
  return Select(all, rule == PruningRule::kObserved ? ChooseMostObserved(all, options.pruning)
                                                    : ChooseAny(all, input, options.pruning));
}

}  // namespace floorloc
