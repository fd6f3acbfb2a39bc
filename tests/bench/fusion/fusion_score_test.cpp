// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fusion_score.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

constexpr std::int64_t kStepNs = 100'000'000;

// Ten seconds along x at 1 m/s, with exact estimates.
std::vector<FusionSample> RightSamples() {
  std::vector<FusionSample> samples;
  for (int i = 0; i < 100; ++i) {
    FusionSample sample{i * kStepNs, FusedPose(), Pose2(0.1 * i, 0.0, 0.0)};
    sample.estimate->map_from_base = sample.truth;
    sample.estimate->covariance = 1e-4 * Eigen::Matrix3d::Identity();
    sample.estimate->state = TrackingState::kLocalized;
    samples.push_back(sample);
  }
  return samples;
}

void Shift(FusionSample& sample, double error_m) {
  const Pose2& truth = sample.truth;
  sample.estimate->map_from_base = Pose2(truth.x() + error_m, truth.y(), truth.yaw());
}

TEST(FusionScore, OfRightPosesIsPerfect) {
  const FusionScore score = ScoreFusion(RightSamples(), {});
  EXPECT_EQ(score.samples, 100U);
  EXPECT_EQ(score.called_good, 100U);
  EXPECT_EQ(score.wrong_called_good, 0U);
  EXPECT_NEAR(score.RmseM(), 0.0, 1e-12);
  EXPECT_NEAR(score.worst_jump_m, 0.0, 1e-12);
}

TEST(FusionScore, CountsErrorsJumpsAndNees) {
  std::vector<FusionSample> samples = RightSamples();
  Shift(samples[50], 0.06);
  Shift(samples[60], 0.04);
  samples[70].estimate->state = TrackingState::kTrackingOdometry;
  Shift(samples[70], 0.08);
  const FusionScore score = ScoreFusion(samples, {});
  EXPECT_EQ(score.wrong_called_good, 1U);  // 40 mm is not wrong, and 80 mm was not called good
  EXPECT_EQ(score.called_good, 99U);
  EXPECT_NEAR(score.worst_jump_m, 0.08, 1e-9);
  EXPECT_NEAR(score.RmseM(), std::sqrt((0.0036 + 0.0016 + 0.0064) / 100.0), 1e-9);
  EXPECT_NEAR(score.MeanNees(), (36.0 + 16.0 + 64.0) / 100.0, 1e-6);
}

TEST(FusionScore, TimesTheRecoveryFromAKidnap) {
  std::vector<FusionSample> samples = RightSamples();
  for (std::size_t i = 30; i < 45; ++i) {
    Shift(samples[i], 1.0);
  }
  Shift(samples[49], 1.0);  // right for less than a second only
  const FusionScore score = ScoreFusion(samples, {3'000'000'000});
  ASSERT_EQ(score.recovery_s.size(), 1U);
  EXPECT_NEAR(score.recovery_s[0], 2.0, 1e-9);
  EXPECT_EQ(score.never_recovered, 0);
  EXPECT_EQ(score.wrong_called_good, 16U);
  EXPECT_EQ(score.judged, 80U);  // two seconds are excluded
  EXPECT_NEAR(score.worst_jump_m, 0.0, 1e-9);
}

TEST(FusionScore, NoticesThatThereWasNoRecovery) {
  std::vector<FusionSample> samples = RightSamples();
  for (std::size_t i = 30; i < samples.size(); ++i) {
    Shift(samples[i], 1.0);
  }
  const FusionScore score = ScoreFusion(samples, {3'000'000'000, 6'000'000'000});
  EXPECT_EQ(score.never_recovered, 2);
  EXPECT_TRUE(score.recovery_s.empty());
}

TEST(FusionScore, LeavesOutTimesWithoutAPose) {
  std::vector<FusionSample> samples = RightSamples();
  samples[0].estimate.reset();
  samples[1].estimate.reset();
  EXPECT_EQ(ScoreFusion(samples, {}).samples, 98U);
}

}  // namespace
}  // namespace floorloc
