// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "server/bridge/bridge_config.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// The configuration file, and the same bytes as --broker.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  BridgeConfig config;
  MayRefuse<JsonError>([&] { config = ParseBridgeConfig(text); });
  MayRefuse<std::invalid_argument>([&] { SetBroker(text, &config.broker); });
  MayRefuse<std::invalid_argument>([&] { config.Check(); });
  return 0;
}
