// SPDX-License-Identifier: Apache-2.0
#include "core/io/input_error.h"
#include "server/http/access.h"
#include "tests/fuzz/refusal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  MayRefuse<InputError>([&] {
    const AccessTokens tokens = ParseTokens(FuzzedText(data, size), "tokens");
    if (const Principal* who = tokens.Find("Bearer test")) {
      who->MayChangeVehicle("agv7");
    }
  });
  return 0;
}
