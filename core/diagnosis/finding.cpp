// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/finding.h"

#include <algorithm>

namespace floorloc {

const char* ToString(FindingStatus status) {
  switch (status) {
    case FindingStatus::kOk:
      return "ok";
    case FindingStatus::kUnknown:
      return "unknown";
    case FindingStatus::kNote:
      return "note";
    case FindingStatus::kWrong:
      return "wrong";
  }
  return "";
}

FindingStatus WorstOf(const std::vector<Finding>& findings) {
  FindingStatus worst = FindingStatus::kOk;
  for (const Finding& finding : findings) {
    worst = std::max(worst, finding.status);
  }
  return worst;
}

}  // namespace floorloc
