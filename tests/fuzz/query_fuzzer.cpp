// SPDX-License-Identifier: Apache-2.0
#include "server/api/localize_json.h"
#include "server/api/tracking_json.h"
#include "server/wire/problem.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/refusal.h"

// Names and values by turns, as the HTTP library hands them over.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  ByteSource source({data, size});
  HttpRequest request;
  while (!source.empty()) {
    const std::string name = source.Text();
    request.query.emplace(name, source.Text());
  }
  MayRefuse<Problem>([&] { ParseLocalizeQuery(request); });
  MayRefuse<Problem, JsonError>([&] { ParseFrameQuery(request); });
  return 0;
}
