// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "server/wire/chunked_framing.h"
#include "server/wire/problem.h"
#include "server/wire/request_head.h"
#include "tests/fuzz/refusal.h"

// A head that grows byte by byte ends where it ends at once; a body of chunks is accepted in pieces as it is as a
// whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  const std::optional<std::size_t> end = HeadScanner().FindEnd(text);
  HeadScanner slow;
  std::optional<std::size_t> slow_end;
  ChunkedFraming pieces;
  for (std::size_t i = 1; i <= text.size(); ++i) {
    slow_end = slow_end ? slow_end : slow.FindEnd(std::string_view(text).substr(0, i));
    pieces.Accept(std::string_view(text).substr(i - 1, 1));
  }
  ChunkedFraming whole;
  whole.Accept(text);
  if (end.has_value() != slow_end.has_value() || (end && *slow_end > *end) || whole.complete() != pieces.complete()) {
    std::abort();
  }
  MayRefuse<Problem>([&] { ParseRequestHead(std::string_view(text).substr(0, end.value_or(text.size()))); });
  return 0;
}
