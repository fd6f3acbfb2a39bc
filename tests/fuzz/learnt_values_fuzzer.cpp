// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/tracking/vehicle_tracker.h"

// The bytes as what a server kept of a vehicle whose checksum is right: what is accepted can be gone on with, and kept.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<double> numbers(size / sizeof(double));
  if (!numbers.empty()) {
    std::memcpy(numbers.data(), data, numbers.size() * sizeof(double));
  }
  if (const auto learnt = floorloc::FromNumbers(numbers)) {
    floorloc::VehicleTracker tracker({}, 0.001);
    tracker.Resume(*learnt);
    tracker.SetPose({1'000'000'000, {}, Eigen::Matrix3d::Identity()});
    tracker.Camera();
    if (!floorloc::FromNumbers(floorloc::ToNumbers(tracker.Learnt()))) {
      std::abort();
    }
  }
  return 0;
}
