// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/start_methods.h"

#include <stdexcept>

#include "core/tracking/vehicle_tracker.h"
#include "tests/bench/ambiguity/frame_evidence.h"
#include "tests/bench/ambiguity/particle_filter.h"

namespace floorloc {
namespace {

class TrackerStart : public StartMethod {
 public:
  explicit TrackerStart(const Localizer& localizer) : tracker_(MakeHallTracker(localizer)) {}

  void Move(const MotionIncrement& motion) override { tracker_.AddOdometry(motion); }
  std::optional<Pose2> See(const RecordedFrame& frame) override {
    tracker_.AddFrame(frame.stamp_ns, Features(), frame.global);
    const std::optional<FusedPose> pose = tracker_.EstimateAt(frame.stamp_ns);
    return pose && pose->state == TrackingState::kLocalized ? std::optional(pose->map_from_base) : std::nullopt;
  }

 private:
  VehicleTracker tracker_;
};

// Takes the best pose of every frame, as most place recognition does.
class BestCandidateStart : public StartMethod {
 public:
  void Move(const MotionIncrement& /*motion*/) override {}
  std::optional<Pose2> See(const RecordedFrame& frame) override {
    return frame.global.inliers > 0 ? std::optional(frame.global.map_from_base) : std::nullopt;
  }
};

class ParticleStart : public StartMethod {
 public:
  ParticleStart(const RectM& extent, std::uint64_t seed) : filter_(ParticleFilterOptions{.seed = seed}, extent) {}

  void Move(const MotionIncrement& motion) override { filter_.Move(motion.motion); }
  std::optional<Pose2> See(const RecordedFrame& frame) override {
    filter_.See(EvidenceOf(frame.global));
    return filter_.Localized();
  }

 private:
  ParticleFilter filter_;
};

}  // namespace

std::vector<std::string> StartMethodNames() { return {"floorloc", "best candidate", "1,000 particles"}; }

std::unique_ptr<StartMethod> MakeStartMethod(const std::string& name, const Localizer& localizer, std::uint64_t seed) {
  const std::vector<std::string> names = StartMethodNames();
  if (name == names[0]) {
    return std::make_unique<TrackerStart>(localizer);
  }
  if (name == names[1]) {
    return std::make_unique<BestCandidateStart>();
  }
  if (name == names[2]) {
    return std::make_unique<ParticleStart>(localizer.map().info.extent, seed);
  }
  throw std::invalid_argument("no method named '" + name + "'");
}

}  // namespace floorloc
