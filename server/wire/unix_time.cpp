// SPDX-License-Identifier: Apache-2.0
#include "server/wire/unix_time.h"

#include <chrono>

namespace floorloc {

double UnixTimeNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace floorloc
