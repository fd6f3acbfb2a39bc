// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace floorloc {

enum class FindingStatus {
  kOk,
  kUnknown,  ///< not enough was driven yet to tell
  kNote,     ///< works, and would work better otherwise
  kWrong,    ///< has to be mended
};
/// "ok", "unknown", "note", "wrong"
const char* ToString(FindingStatus status);

/// What a drive says of a part of a robot.
struct Finding {
  std::string about;  ///< "floor", "images", "camera", "odometry", "clock", "gyro"
  FindingStatus status = FindingStatus::kOk;
  std::string sentence;  ///< what was seen, with numbers
  std::string cure;      ///< what to do; empty: nothing
};

/// The worst of the findings; kOk without any.
FindingStatus WorstOf(const std::vector<Finding>& findings);

}  // namespace floorloc
