// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/bridge/instant_actions.h"
#include "server/bridge/server_reports.h"

namespace floorloc {

/// How an action ended.
struct ActionVerdict {
  std::string action_id;
  bool succeeded = false;
  std::string sentence;
};

/// A pose that was lost meanwhile is found again: where it was set when it is no further from there than this, the gate
/// of floorloc-server by default.
struct ConfirmationOptions {
  double max_distance_m = 0.2;
  double max_angle_rad = 0.1745;
};

/// Waits for the image that confirms or contradicts an initial pose. Images that are found nowhere, or are refused for
/// another reason than their place, say neither.
class PoseConfirmation {
 public:
  explicit PoseConfirmation(ConfirmationOptions options = {}) : options_(options) {}

  struct Expected {
    InitPosition pose;
    std::int64_t after_sequence = 0;  ///< of the last fix before the pose was set
    double deadline_s = 0.0;
  };
  /// One that is waited for already has failed.
  std::optional<ActionVerdict> Start(const std::string& action_id, const Expected& expected);
  std::optional<ActionVerdict> OnFix(const FixReport& fix);
  std::optional<ActionVerdict> OnTime(double now_s);

 private:
  struct Waiting {
    std::string action_id;
    Expected expected;
  };

  bool Contradicts(const FixReport& fix) const;
  std::optional<ActionVerdict> End(bool succeeded, const std::string& sentence);

  ConfirmationOptions options_;
  std::optional<Waiting> waiting_;
};

}  // namespace floorloc
