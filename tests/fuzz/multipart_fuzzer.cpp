// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>

#include "server/wire/multipart.h"
#include "server/wire/problem.h"
#include "tests/fuzz/refusal.h"

// The Content-Type header, a zero byte, the body. Parts are pieces of the body.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  const std::size_t end = std::min(text.find('\0'), text.size());
  const std::string body = text.substr(std::min(end + 1, text.size()));
  MayRefuse<Problem>([&] {
    std::size_t total = 0;
    for (const HttpPart& part : ParseMultipart(body, text.substr(0, end))) {
      total += part.content.size();
    }
    if (total > body.size()) {
      std::abort();
    }
  });
  return 0;
}
