// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// Unix time now, seconds.
double UnixTimeNow();

}  // namespace floorloc
