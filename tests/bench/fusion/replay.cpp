// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/replay.h"

#include <memory>

namespace floorloc {
namespace {

// Hands over one message of any kind.
struct Deliver {
  PoseFuser& fuser;
  bool uses_imu;

  void operator()(const MotionIncrement& increment) const { fuser.AddIncrement(MotionSource::kWheels, increment); }
  void operator()(const ImuReading& reading) const {
    if (uses_imu) {
      fuser.AddImu(reading);
    }
  }
  void operator()(const PoseFix& fix) const { fuser.AddFix(fix); }
  void operator()(const PictureMiss& miss) const { fuser.AddMiss(miss.stamp_ns); }
};

}  // namespace

std::vector<FusionVariant> AllFusionVariants() {
  return {{"increments only", FusionMethod::kIncrements},
          {"fixes only", FusionMethod::kFixes},
          {"replace on fix (thesis)", FusionMethod::kReplace},
          {"jump filter (thesis)", FusionMethod::kJumpFilter},
          {"floorloc", FusionMethod::kEkf},
          {"floorloc with IMU", FusionMethod::kEkf, true}};
}

std::vector<FusionSample> ReplayMessages(const std::vector<FusionMessage>& messages, const Trajectory& truth,
                                         const FusionVariant& variant) {
  const std::unique_ptr<PoseFuser> fuser = MakePoseFuser(variant.method, PoseFilterOptions());
  std::vector<FusionSample> samples;
  for (const FusionMessage& message : messages) {
    std::visit(Deliver{*fuser, variant.uses_imu}, message.content);
    if (const auto* increment = std::get_if<MotionIncrement>(&message.content)) {
      const StampedPose3& pose = truth.at(samples.size() + 1);  // the first row is before the first increment
      samples.push_back({increment->to_ns, fuser->EstimateAt(increment->to_ns), pose.ToPose2()});
    }
  }
  return samples;
}

}  // namespace floorloc
