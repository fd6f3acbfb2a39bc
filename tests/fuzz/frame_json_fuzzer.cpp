// SPDX-License-Identifier: Apache-2.0
#include "server/api/tracking_json.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  floorloc::MayRefuse<floorloc::JsonError>([&] { floorloc::ParseFrameJson(floorloc::FuzzedText(data, size)); });
  return 0;
}
