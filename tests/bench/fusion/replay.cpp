// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/replay.h"

#include <memory>

namespace floorloc {
namespace {

// Passes a message of any type to the fuser.
struct Deliver {
  PoseFuser& fuser;
  const FusionVariant& variant;

  void operator()(const MotionMessage& motion) const {
    if (motion.source == MotionSource::kWheels ? variant.uses_wheels : variant.uses_visual_motion) {
      fuser.AddIncrement(motion.source, motion.increment);
    }
  }
  void operator()(const ImuReading& reading) const {
    if (variant.uses_imu) {
      fuser.AddImu(reading);
    }
  }
  void operator()(const PoseFix& fix) const { fuser.AddFix(fix); }
  void operator()(const LocalizationFailure& miss) const { fuser.AddUnlocalizedFrame(miss.stamp_ns); }
};

}  // namespace

std::vector<FusionVariant> AllFusionVariants() {
  return {{"increments only", FusionMethod::kIncrements},     {"fixes only", FusionMethod::kFixes},
          {"thesis: replace on fix", FusionMethod::kReplace}, {"thesis: jump filter", FusionMethod::kJumpFilter},
          {"floorloc: wheels", FusionMethod::kEkf},           {"+ images' motion", FusionMethod::kEkf, true},
          {"+ IMU", FusionMethod::kEkf, true, true}};
}

void DeliverMessage(const FusionMessage& message, const FusionVariant& variant, PoseFuser* fuser) {
  std::visit(Deliver{*fuser, variant}, message.content);
}

std::vector<FusionSample> ReplayMessages(const std::vector<FusionMessage>& messages, const Trajectory& truth,
                                         const FusionVariant& variant) {
  const std::unique_ptr<PoseFuser> fuser = MakePoseFuser(variant.method, variant.options);
  std::vector<FusionSample> samples;
  for (const FusionMessage& message : messages) {
    DeliverMessage(message, variant, fuser.get());
    const auto* motion = std::get_if<MotionMessage>(&message.content);
    if (motion != nullptr && motion->source == MotionSource::kWheels) {
      const StampedPose3& pose = truth.at(samples.size() + 1);  // the first row is before the first motion
      const std::int64_t now_ns = motion->increment.to_ns;
      samples.push_back({now_ns, fuser->EstimateAt(now_ns), pose.ToPose2()});
    }
  }
  return samples;
}

}  // namespace floorloc
