// SPDX-License-Identifier: Apache-2.0
#include "server/api/tracking_json.h"
#include "server/wire/strict_json.h"
#include "tests/fuzz/refusal.h"

// What is accepted becomes the pose of a vehicle that then moves, and comes out as an answer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  MayRefuse<JsonError>([&] {
    const InitialPoseRequest request = ParseInitialPoseJson(FuzzedText(data, size));
    VehicleSession session({}, 0.001, 0.0);
    session.SetPose(request.pose, request.stamp_ns);
    const std::int64_t stamp_ns = request.stamp_ns.value_or(0);
    const std::int64_t later_ns = stamp_ns + 100'000'000;
    FormatInitialPoseResponse(session.AddOdometry({{stamp_ns, {}}, {later_ns, {0.1, 0.0, 0.0}}}).view, {"hall", "1"});
  });
  return 0;
}
