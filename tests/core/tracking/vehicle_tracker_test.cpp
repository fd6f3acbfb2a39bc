// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/vehicle_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr std::int64_t kStartNs = 1'000'000'000'000;
constexpr std::int64_t kFrameNs = 250'000'000;

const SyntheticFloor& Floor() {
  static const SyntheticFloor floor(1);
  return floor;
}

// A localizer of the synthetic floor, in the floor's own frame.
const Localizer& TheLocalizer() {
  static const TemporaryFolder folder;
  static const std::unique_ptr<const Localizer> localizer = [] {
    Floor().WriteSurvey(folder.path() / "survey");
    BuildOptions options;
    options.surveys = {folder.path() / "survey"};
    options.out = folder.path() / "floor.floormap";
    options.poses = ReadTum(folder.path() / "survey" / "groundtruth.tum");
    BuildMap(options);
    return std::make_unique<const Localizer>(MapDatabase(options.out).ReadMap(), LocalizerOptions{});
  }();
  return *localizer;
}

// A vehicle on the floor. Frame i is taken i frame intervals after the start.
class VehicleTrackerTest : public testing::Test {
 protected:
  VehicleTrackerTest() : tracker_(TrackerOptions{}, Floor().camera().floor.resolution_m) {}

  static std::int64_t Stamp(int frame) { return kStartNs + frame * kFrameNs; }

  FrameOutcome Send(int frame, const Pose2& truth) {
    cv::Mat gray;
    cv::cvtColor(Floor().View(truth), gray, cv::COLOR_BGR2GRAY);
    const FrameObservation observation = TheLocalizer().Observe(rectifier_, gray);
    prior_ = tracker_.Prior(Stamp(frame));
    return tracker_.AddFrame(Stamp(frame), observation.features,
                             TheLocalizer().LocalizeWithGlobalFallback(observation, prior_));
  }

  // A frame of a floor that is not in the map.
  FrameOutcome SendFromOtherFloor(int frame, const SyntheticFloor& floor, const Pose2& truth) {
    cv::Mat gray;
    cv::cvtColor(floor.View(truth), gray, cv::COLOR_BGR2GRAY);
    const FrameObservation observation = TheLocalizer().Observe(rectifier_, gray);
    prior_ = tracker_.Prior(Stamp(frame));
    return tracker_.AddFrame(Stamp(frame), observation.features,
                             TheLocalizer().LocalizeWithGlobalFallback(observation, prior_));
  }

  // A slow path along the middle of the floor, turning left.
  static Pose2 PoseAt(int frame) { return Floor().BaseForView(0.4 + 0.02 * frame, 0.45, 0.1 * frame); }

  void ExpectNear(const Pose2& truth, double tolerance_m = 2e-3) const {
    const auto pose = tracker_.Estimate();
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT(pose->map_from_base.Between(truth).translation().norm(), tolerance_m) << pose->map_from_base << truth;
  }

  Rectifier rectifier_{Floor().camera()};
  VehicleTracker tracker_;
  std::optional<PosePrior> prior_;
};

TEST_F(VehicleTrackerTest, SearchesTheWholeMapFirstAndThenAroundThePose) {
  EXPECT_TRUE(Send(0, PoseAt(0)).fix->first);
  EXPECT_FALSE(prior_.has_value());
  EXPECT_TRUE(Send(1, PoseAt(1)).fix->accepted);
  EXPECT_TRUE(Send(2, PoseAt(2)).fix->accepted);  // the velocity is known now
  ASSERT_TRUE(prior_.has_value());
  EXPECT_LE(prior_->radius_m, 0.5);
  EXPECT_LT(prior_->map_from_base.Between(PoseAt(2)).translation().norm(), prior_->radius_m);
  ExpectNear(PoseAt(2));
}

TEST_F(VehicleTrackerTest, VisualOdometryBridgesUnmappedFloor) {
  // The floor has changed completely at the vehicle's place, but visual odometry still works.
  const SyntheticFloor other(7);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(Send(i, PoseAt(i)).fix->accepted);
  }
  ASSERT_FALSE(
      SendFromOtherFloor(4, other, PoseAt(3)).fix.has_value());  // the other floor begins here, without any match
  for (int i = 5; i < 12; ++i) {
    EXPECT_FALSE(SendFromOtherFloor(i, other, PoseAt(i - 1)).fix.has_value());
  }
  const FusedPose pose = *tracker_.Estimate();
  EXPECT_NE(pose.state, TrackingState::kLocalized);
  // The motion between frames 3 and 4 was not measured; later motions are measured by images.
  const Pose2 moved = tracker_.EstimateAt(Stamp(6))->map_from_base.Between(pose.map_from_base);
  const Pose2 truth = PoseAt(5).Between(PoseAt(10));
  EXPECT_LT(moved.Between(truth).translation().norm(), 3e-3);
}

TEST_F(VehicleTrackerTest, WithoutVisualOdometryImagesGiveFixesOnly) {
  TrackerOptions options;
  options.visual_odometry = false;
  tracker_ = VehicleTracker(options, Floor().camera().floor.resolution_m);
  EXPECT_FALSE(Send(0, PoseAt(0)).visual_used);
  EXPECT_FALSE(Send(1, PoseAt(1)).visual_used);
}

TEST_F(VehicleTrackerTest, IsFoundAgainAfterAKidnap) {
  for (int i = 0; i < 4; ++i) {
    Send(i, PoseAt(i));
    tracker_.AddOdometry({Stamp(i), Stamp(i + 1), PoseAt(i).Between(PoseAt(i + 1)), std::nullopt});
  }
  const Pose2 elsewhere = Floor().BaseForView(0.85, 0.4, 3.0);
  std::vector<FrameOutcome> outcomes;
  for (int i = 4; i < 8; ++i) {
    outcomes.push_back(Send(i, elsewhere));
    if (i > 4 && i < 7) {
      EXPECT_FALSE(prior_.has_value()) << "in doubt, the whole map is searched";
    }
    tracker_.AddOdometry({Stamp(i), Stamp(i + 1), {}, std::nullopt});
  }
  EXPECT_FALSE(outcomes[0].fix->accepted);
  EXPECT_TRUE(outcomes[2].fix->reanchored);
  EXPECT_TRUE(outcomes[3].fix->accepted);
  ExpectNear(elsewhere);
}

TEST_F(VehicleTrackerTest, ALateImageIsAFixOfItsOwnTime) {
  Send(0, PoseAt(0));
  tracker_.AddOdometry({Stamp(0), Stamp(2), PoseAt(0).Between(PoseAt(2)), std::nullopt});
  Send(2, PoseAt(2));
  const FrameOutcome late = Send(1, PoseAt(0) * Pose2::Exp(0.5 * PoseAt(0).Between(PoseAt(2)).Log()));
  EXPECT_FALSE(late.visual_used);
  EXPECT_TRUE(late.fix->accepted);
  ExpectNear(PoseAt(2));
}

TEST_F(VehicleTrackerTest, RequestsImagesWhileUncertain) {
  EXPECT_EQ(tracker_.Next().seconds, 0.0);
  Send(0, PoseAt(0));
  const NextFrame next = tracker_.Next();
  EXPECT_GT(next.seconds, 0.5);
  EXPECT_GT(next.metres, 0.1);
  tracker_.AddOdometry({Stamp(0), Stamp(1), Pose2(0.1, 0, 0), std::nullopt});
  EXPECT_LT(tracker_.Next().seconds, next.seconds);
  EXPECT_LT(tracker_.Next().metres, next.metres);
}

// Path until the next image, after fixes every half metre between which the wheels are off by the given share of what
// the fuser can believe, to either side in turn.
double NextMetresAfterDrive(double scatter) {
  TrackerOptions options;
  options.visual_odometry = false;
  VehicleTracker tracker(options, 1e-3);
  LocalizationResult found;
  found.status = LocalizationStatus::kLocalized;
  found.covariance = Eigen::Vector3d(1e-7, 1e-7, 1e-6).asDiagonal();
  found.p_wrong = 1e-9;
  double off_m = 0.008;
  for (int i = 0; i < 30; ++i) {
    const std::int64_t stamp_ns = kStartNs + i * kFrameNs;
    if (i > 0) {
      const double error_m = (i % 2 == 0 ? scatter : -scatter) * off_m;
      tracker.AddOdometry({stamp_ns - kFrameNs, stamp_ns, Pose2(0.5, error_m, 0.0), std::nullopt});
      off_m = std::min(0.05, 1.1 * off_m);
    }
    found.map_from_base = Pose2(0.5 * i, 0.0, 0.0);
    const FrameOutcome outcome = tracker.AddFrame(stamp_ns, {}, found);
    EXPECT_TRUE(outcome.fix.has_value() && outcome.fix->accepted) << i;
  }
  return tracker.Next().metres;
}

TEST(VehicleTrackerNextTest, WheelsThatProveWorseThanTheirOptionsWantPicturesSooner) {
  EXPECT_EQ(NextMetresAfterDrive(0.0), NextFrameOptions().max_m);
  EXPECT_LT(NextMetresAfterDrive(1.0), 0.8 * NextFrameOptions().max_m);
}

}  // namespace
}  // namespace floorloc
