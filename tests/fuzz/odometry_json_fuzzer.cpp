// SPDX-License-Identifier: Apache-2.0
#include "server/api/tracking_json.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// What is accepted goes into the pose of a vehicle whose place is known, and comes out as an answer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  MayRefuse<JsonError>([&] {
    const std::vector<OdometryMessage> messages = ParseOdometryJson(FuzzedText(data, size));
    VehicleSession session({}, 0.001, 0.0);
    session.SetPose({}, std::nullopt);
    FormatOdometryResponse(session.AddOdometry(messages), {"hall", "1"});
  });
  return 0;
}
