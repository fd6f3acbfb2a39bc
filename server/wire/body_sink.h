// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

namespace floorloc {

/// Takes a body as it arrives: for calls whose bodies are too large for memory.
class BodySink {
 public:
  virtual ~BodySink() = default;
  /// The next bytes. Throws Problem to refuse the rest, when they are too many for instance.
  virtual void Write(std::string_view bytes) = 0;
};

/// Where a body goes.
struct BodyStream {
  std::shared_ptr<BodySink> sink;
  std::uint64_t max_bytes = 0;  ///< that the sink takes
};

}  // namespace floorloc
