// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/probe_sequence.h"

#include <algorithm>
#include <cassert>
#include <compare>
#include <functional>
#include <queue>

namespace floorloc {
namespace {

// The r-th smallest of uniformly distributed margins grows linearly with r, its square about as this.
int CostOf(int rank) { return (rank + 1) * (rank + 2); }

struct Candidate {
  int cost = 0;
  int rank = 0;
  int parent = 0;
  int parent_cost = 0;
  auto operator<=>(const Candidate&) const = default;
};

}  // namespace

ProbeSequence::ProbeSequence(int ranks, int count) {
  assert(ranks <= 255 && count <= 65536);
  probes_.push_back({});
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> next;
  if (ranks > 0) {
    next.push({CostOf(0), 0, 0, 0});
  }
  while (!next.empty() && static_cast<int>(probes_.size()) < count) {
    const Candidate c = next.top();
    next.pop();
    const auto index = static_cast<int>(probes_.size());
    probes_.push_back({static_cast<std::uint16_t>(c.parent), static_cast<std::uint8_t>(c.rank)});
    // Every set has exactly one parent: its largest rank is increased by one or newly added.
    if (c.rank + 1 < ranks) {
      next.push({c.parent_cost + CostOf(c.rank + 1), c.rank + 1, c.parent, c.parent_cost});
      next.push({c.cost + CostOf(c.rank + 1), c.rank + 1, index, c.cost});
    }
  }
}

}  // namespace floorloc
