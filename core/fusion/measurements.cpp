// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/measurements.h"

#include <cmath>

namespace floorloc {

std::int64_t ToNanoseconds(double seconds) { return std::llround(1e9 * seconds); }

const char* ToString(MessageOutcome outcome) {
  switch (outcome) {
    case MessageOutcome::kUsed:
      return "used";
    case MessageOutcome::kUsedLate:
      return "used_late";
    case MessageOutcome::kDuplicate:
      return "duplicate";
    case MessageOutcome::kTooOld:
      return "too_old";
    case MessageOutcome::kClockJump:
      return "clock_jump";
    case MessageOutcome::kInvalid:
      return "invalid";
    case MessageOutcome::kCount:
      break;
  }
  return "";
}

}  // namespace floorloc
