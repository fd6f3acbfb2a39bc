// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/bench/fusion/replay.h"

namespace floorloc {

/// A pose beyond one of these is wrong.
inline constexpr double kWrongM = 0.05;
inline constexpr double kWrongRad = 0.05235987755982988;  // 3 degrees

/// Score of a fusion method over one or several drives.
struct FusionScore {
  std::size_t samples = 0;      ///< with a pose
  std::size_t called_good = 0;  ///< of these, reported as "localized"
  std::size_t wrong_called_good = 0;
  std::size_t judged = 0;  ///< not within kSettleS after a kidnap; the next two sums are over these
  double squared_error_m2 = 0.0;
  double nees = 0.0;          ///< sum
  double worst_jump_m = 0.0;  ///< largest step in excess of the true motion, except between a kidnap and the recovery
  std::vector<double> recovery_s;  ///< from a kidnap until the pose is right and stays so for a second
  int never_recovered = 0;

  double RmseM() const;
  double MeanNees() const;
  void Add(const FusionScore& other);
};

/// Time after a kidnap that RMSE and NEES exclude: it cannot be detected before the next images.
inline constexpr double kSettleS = 2.0;

FusionScore ScoreFusion(const std::vector<FusionSample>& samples, const std::vector<std::int64_t>& kidnaps_ns);

}  // namespace floorloc
