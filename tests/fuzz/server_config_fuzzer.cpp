// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "server/config/config_json.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// The configuration file, and the same bytes as --listen.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  const std::string text = FuzzedText(data, size);
  ServerConfig config;
  MayRefuse<JsonError>([&] { config = ParseServerConfig(text); });
  MayRefuse<std::invalid_argument>([&] { SetListenAddress(text, config); });
  MayRefuse<std::invalid_argument>([&] { config.Check(); });
  return 0;
}
