// SPDX-License-Identifier: Apache-2.0
#include "server/api/vehicle_json.h"
#include "server/serving/rectifier_store.h"
#include "server/wire/problem.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// A camera that is accepted gets its lookup tables, as long as they are small; its mask, if any, is decoded.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  constexpr std::int64_t kMaxPixels = 100'000;
  MayRefuse<JsonError, Problem>([&] {
    const VehicleRequest request = ParseVehicleRequest(FuzzedText(data, size));
    RectifierStore({kMaxPixels, std::size_t{1} << 20, 1}).Get(request.camera.camera, request.camera.mask);
  });
  return 0;
}
