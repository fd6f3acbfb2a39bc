// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "core/io/delimited_text.h"
#include "core/io/trajectory.h"
#include "tests/fuzz/refusal.h"

// A time that was read is written so that it is read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  ParseNumber(text);
  const std::optional<std::int64_t> stamp_ns = ParseSeconds(text);
  if (stamp_ns && ParseSeconds(FormatSeconds(*stamp_ns)) != stamp_ns) {
    std::abort();
  }
  return 0;
}
