// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/instant_actions.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// What a broker delivers on any topic that the bridge listens to.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  MayRefuse<JsonError>([&] {
    for (const InstantAction& action : ParseInstantActions(text)) {
      MayRefuse<JsonError>([&] { ParseCommand(action); });
    }
  });
  MayRefuse<JsonError>([&] { ParseOrder(text); });
  MayRefuse<JsonError>([&] { ParseHeaderId(text); });
  return 0;
}
