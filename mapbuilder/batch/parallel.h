// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace floorloc {

/// Calls body(0) ... body(count - 1), each once, from up to `threads` threads (0: one per core). The order is open.
/// When a body throws, no further index is started and the first exception is thrown again here.
void ParallelFor(int count, int threads, const std::function<void(int)>& body);

}  // namespace floorloc
