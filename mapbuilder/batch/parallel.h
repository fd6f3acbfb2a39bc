// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace floorloc {

/// Calls body(0) ... body(count - 1) once each, in unspecified order, from up to `threads` threads (0: one per core).
/// When a body throws, no further index is started and the first exception is rethrown.
void ParallelFor(int count, int threads, const std::function<void(int)>& body);

}  // namespace floorloc
