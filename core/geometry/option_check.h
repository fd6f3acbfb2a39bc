// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace floorloc {

/// For the Check() of options: throws std::invalid_argument with a message "FIELD must be RANGE" when a condition does
/// not hold. Conditions say what must hold, so that NaN fails them.
inline void RequireOption(bool holds, const char* message) {
  if (!holds) {
    throw std::invalid_argument(message);
  }
}

}  // namespace floorloc
