// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/scenes/frame_plan.h"

namespace floorloc {

/// Result of one call of the localizer.
struct FixRecord {
  SearchKind search = SearchKind::kGlobal;
  LocalizationStatus status = LocalizationStatus::kNotLocalized;
  bool has_pose = false;  ///< also for a frame that was not accepted: its best hypothesis
  double p_wrong = 1.0;
  double error_m = 0.0;  ///< position error; infinite when the frame is not on the map's floor
  double error_rad = 0.0;
  double nees = 0.0;
  int inliers = 0;
  std::optional<double> support_area;  ///< share of the view that agrees
  bool truth_listed = false;           ///< ambiguous, and the truth is among the alternatives
  double localize_ms = 0.0;

  bool accepted() const { return status == LocalizationStatus::kLocalized; }
  /// True when the error exceeds 10 mm or 1 degree.
  bool wrong() const;
};

struct FrameRecord {
  int frame = 0;
  FramePlace place = FramePlace::kMap;
  std::string condition;
  double render_ms = 0.0;
  std::vector<FixRecord> fixes;
};

/// One JSON object without a line break.
std::string ToJsonLine(const FrameRecord& record);
/// Throws an exception derived from std::exception when the text is not such a line.
FrameRecord ParseFrameRecord(const std::string& line);

}  // namespace floorloc
