// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/truth_record.h"

#include <algorithm>

namespace floorloc {

namespace {
constexpr double kJumpM = 0.15;    // no vehicle drives so far between two entries
constexpr double kBeyondS = 0.05;  // a stamp with jitter may be later than the last entry
}  // namespace

void TruthRecord::Add(double time_s, const Pose2& map_from_base) {
  entries_.push_back({time_s, map_from_base});
  while (entries_.front().time_s < time_s - kept_s_) {
    entries_.pop_front();
  }
}

std::optional<Pose2> TruthRecord::At(double time_s) const {
  constexpr double kRoundingS = 1e-5;  // stamps of answers are doubles of Unix time
  if (entries_.size() < 2 || time_s < entries_.front().time_s - kRoundingS ||
      time_s > entries_.back().time_s + kBeyondS) {
    return std::nullopt;
  }
  auto after = std::lower_bound(entries_.begin() + 1, entries_.end(), time_s,
                                [](const Entry& entry, double time) { return entry.time_s < time; });
  after = std::min(after, entries_.end() - 1);
  const Entry& before = *std::prev(after);
  const Pose2 motion = before.map_from_base.Between(after->map_from_base);
  if (motion.translation().norm() > kJumpM) {
    return time_s < after->time_s ? before.map_from_base : after->map_from_base;
  }
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  return before.map_from_base * Pose2::Exp(share * motion.Log());
}

}  // namespace floorloc
