// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace floorloc {

/// Sets of key parts to change, most likely first, when a query's parts are ranked by increasing margin (query-directed
/// probing, Lv et al. 2007). The sets are the same for every query; only the ranking of its parts differs.
class ProbeSequence {
 public:
  /// A set of ranks: that of an earlier probe and one more rank. The first probe is the empty set and its own parent.
  struct Probe {
    std::uint16_t parent = 0;
    std::uint8_t rank = 0;
  };

  /// ranks: number of key parts, at most 255. count: probes, at most 65536; fewer when there are fewer sets.
  ProbeSequence(int ranks, int count);

  const std::vector<Probe>& probes() const { return probes_; }

 private:
  std::vector<Probe> probes_;
};

}  // namespace floorloc
