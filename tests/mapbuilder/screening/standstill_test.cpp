// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/standstill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/imgproc.hpp>

#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/image/rectifier.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class StandstillTest : public ::testing::Test {
 protected:
  StandstillTest() : rectifier_(floor_.camera()) {
    registration_.resolution_m = floor_.camera().floor.resolution_m;
    registration_.run.threads = 1;
  }

  // Adds a frame at this pose with independent noise.
  void AddFrame(double x_m, double yaw_rad = 0.0) {
    RenderConditions conditions;
    conditions.read_noise = 1.8;
    conditions.noise_seed = frames_.size() + 1;
    cv::Mat gray;
    cv::cvtColor(floor_.View(floor_.BaseForView(0.4 + x_m, 0.4, yaw_rad), conditions), gray, cv::COLOR_BGR2GRAY);
    BuildFrame frame;
    frame.features = extractor_->Extract(rectifier_.Rectify(gray));
    frames_.push_back(std::move(frame));
  }
  StandstillResult Find() const {
    std::vector<int> order(frames_.size());
    std::iota(order.begin(), order.end(), 0);
    return FindStationaryFrames(frames_, order, floor_.camera().floor.roi, registration_);
  }

  SyntheticFloor floor_;
  Rectifier rectifier_;
  std::unique_ptr<FeatureExtractor> extractor_ = CreateFeatureExtractor(ExtractorOptions{});
  PairRegistrationOptions registration_;
  std::vector<BuildFrame> frames_;
};

TEST_F(StandstillTest, OnlyTheFirstOfARunIsNew) {
  for (const double x_m : {0.0, 0.0, 0.0, 0.1, 0.1, 0.2}) {
    AddFrame(x_m);
  }
  EXPECT_THAT(Find().repeated, ElementsAre(1, 2, 4));
  EXPECT_EQ(Find().moved_by_odometry, 0);
}

TEST_F(StandstillTest, SlowMotionIsNone) {
  for (int i = 0; i < 8; ++i) {
    AddFrame(0.0004 * i);  // half a pixel each
  }
  EXPECT_THAT(Find().repeated, IsEmpty());
}

TEST_F(StandstillTest, TheSlowestMotionAddsUp) {
  for (int i = 0; i < 20; ++i) {
    AddFrame(0.0001 * i);  // a seventh of a pixel each
  }
  // About every third frame is kept, so that the path is covered in steps below one pixel.
  const std::size_t kept = frames_.size() - Find().repeated.size();
  EXPECT_GE(kept, 5U);
  EXPECT_LE(kept, 10U);
}

TEST_F(StandstillTest, TurningOnTheSpotIsMotion) {
  AddFrame(0.0);
  AddFrame(0.0, 0.003);
  EXPECT_THAT(Find().repeated, IsEmpty());
}

TEST_F(StandstillTest, RepeatedImagesWhileOdometryMovesAreCounted) {
  AddFrame(0.0);
  AddFrame(0.0);
  frames_[0].odom_from_base = Pose2();
  frames_[1].odom_from_base = Pose2(0.1, 0.0, 0.0);
  EXPECT_EQ(Find().moved_by_odometry, 1);
}

}  // namespace
}  // namespace floorloc
