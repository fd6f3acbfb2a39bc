// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/survey_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace floorloc {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TopicSummary Topic(const std::string& name, const std::string& type, const std::string& frame) {
  TopicSummary topic;
  topic.topic = name;
  topic.type = type;
  topic.messages = 10;
  topic.frame_id = frame;
  if (type.ends_with("Image")) {
    topic.size_px = {640, 480};
  }
  return topic;
}

RosCameraInfo Calibrated() {
  RosCameraInfo info;
  info.width_px = 640;
  info.height_px = 480;
  info.distortion_model = "plumb_bob";
  info.k = {500, 0, 319.5, 0, 500, 239.5, 0, 0, 1};
  return info;
}

TransformSummary Fixed(const std::string& parent, const std::string& child, double z, bool down = false) {
  TransformSummary transform;
  transform.first = {parent, child, Eigen::Isometry3d::Identity()};
  transform.first.parent_from_child.translation().z() = z;
  if (down) {
    transform.first.parent_from_child.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
  }
  transform.messages = 1;
  transform.on_static_topic = true;
  return transform;
}

// A robot as its driver's manual has it: one camera straight down, odometry, an IMU.
BagSummary Usual() {
  BagSummary bag;
  bag.path = "drive";
  bag.topics = {Topic("/camera/camera_info", "sensor_msgs/msg/CameraInfo", "optical"),
                Topic("/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", "optical"),
                Topic("/imu", "sensor_msgs/msg/Imu", "imu_link"), Topic("/odom", "nav_msgs/msg/Odometry", "odom")};
  bag.topics.back().child_frame_id = "base_link";
  bag.cameras["/camera/camera_info"] = Calibrated();
  bag.transforms = {Fixed("base_link", "optical", 0.4, true), Fixed("base_link", "imu_link", 0.1, true)};
  return bag;
}

TEST(SurveyPlanTest, ChoosesTheOnlyTopicOfEachType) {
  const SurveyPlan plan = PlanSurvey(Usual(), {});
  EXPECT_THAT(plan.missing, IsEmpty());
  EXPECT_EQ(plan.image_topic, "/camera/image_raw/compressed");
  EXPECT_EQ(plan.base_frame, "base_link");
  EXPECT_EQ(plan.camera.fx, 500);
  ASSERT_TRUE(plan.odometry.has_value());
  EXPECT_EQ(plan.odometry->topic, "/odom");
  EXPECT_EQ(plan.imu_topic, "/imu");
  EXPECT_EQ(plan.base_from_imu(2, 2), -1.0);
  ASSERT_TRUE(plan.floor.has_value());
  EXPECT_EQ(plan.mounting,
            "/tf_static base_link -> optical: 0.400 m over the floor, looking 90.0 degrees below the horizon");
  EXPECT_THAT(plan.notes, Contains(HasSubstr("base_link is taken to be on the floor")));
}

TEST(SurveyPlanTest, SeveralTopicsAreListedWithTheOption) {
  BagSummary bag = Usual();
  bag.topics.push_back(Topic("/rear/image_raw", "sensor_msgs/msg/Image", "rear"));
  EXPECT_THAT(
      PlanSurvey(bag, {}).missing,
      ElementsAre(
          "has 2 topics of images (/camera/image_raw/compressed, /rear/image_raw); choose one with --image-topic"));
  SurveyChoice choice;
  choice.image_topic = "/camera/image_raw/compressed";
  EXPECT_THAT(PlanSurvey(bag, choice).missing, IsEmpty());
  choice.image_topic = "/front";
  EXPECT_THAT(PlanSurvey(bag, choice).missing,
              ElementsAre(HasSubstr(
                  "has no topic /front of images; --image-topic may be /camera/image_raw/compressed, /rear")));
}

TEST(SurveyPlanTest, TakesRawImagesOfACameraThatWasRecordedBothWays) {
  BagSummary bag = Usual();
  bag.topics.push_back(Topic("/camera/image_raw", "sensor_msgs/msg/Image", "optical"));
  bag.topics.push_back(Topic("/camera/image_raw/compressedDepth", "sensor_msgs/msg/CompressedImage", "optical"));
  const SurveyPlan plan = PlanSurvey(bag, {});
  EXPECT_THAT(plan.missing, IsEmpty());
  EXPECT_EQ(plan.image_topic, "/camera/image_raw");
  EXPECT_THAT(plan.notes, Contains(HasSubstr("rather than /camera/image_raw/compressed")));
}

TEST(SurveyPlanTest, TakesTheCalibrationBesideTheImages) {
  BagSummary bag = Usual();
  bag.topics.push_back(Topic("/rear/camera_info", "sensor_msgs/msg/CameraInfo", "rear"));
  bag.cameras["/rear/camera_info"] = Calibrated();
  bag.cameras["/rear/camera_info"].k[0] = 100;
  EXPECT_EQ(PlanSurvey(bag, {}).camera.fx, 500);
  SurveyChoice choice;
  choice.camera_info_topic = "/rear/camera_info";
  EXPECT_EQ(PlanSurvey(bag, choice).camera.fx, 100);
}

TEST(SurveyPlanTest, SaysWhatAnEmptyBagLacks) {
  BagSummary bag;
  bag.topics = {Topic("/chatter", "std_msgs/msg/String", "")};
  EXPECT_THAT(PlanSurvey(bag, {}).missing, ElementsAre(HasSubstr("has no images; record")));
  bag.topics.push_back(Topic("/image", "sensor_msgs/msg/Image", "optical"));
  EXPECT_THAT(PlanSurvey(bag, {}).missing, ElementsAre(HasSubstr("has no sensor_msgs/CameraInfo; give")));
}

TEST(SurveyPlanTest, SaysThatNothingTellsTheMounting) {
  BagSummary bag = Usual();
  bag.transforms.clear();
  EXPECT_THAT(PlanSurvey(bag, {}).missing,
              ElementsAre(HasSubstr("/tf_static does not connect base_link with the images' frame 'optical'; give the "
                                    "mounting with --floor")));
  SurveyChoice choice;
  choice.needs_floor = false;
  EXPECT_THAT(PlanSurvey(bag, choice).missing, IsEmpty());
}

TEST(SurveyPlanTest, RefusesAMountingThatCannotBe) {
  BagSummary bag = Usual();
  bag.transforms[0] = Fixed("base_link", "optical", 0.4);  // looks up, as a body frame does
  EXPECT_THAT(PlanSurvey(bag, {}).missing,
              ElementsAre(HasSubstr("looking -90.0 degrees below the horizon; correct it")));
}

TEST(SurveyPlanTest, HeightsCountFromTheFootprint) {
  BagSummary bag = Usual();
  bag.transforms.push_back(Fixed("base_footprint", "base_link", 0.15));
  const SurveyPlan plan = PlanSurvey(bag, {});
  ASSERT_TRUE(plan.floor.has_value());
  EXPECT_THAT(plan.mounting, HasSubstr("base_link -> optical: 0.550 m"));
  SurveyChoice choice;
  choice.base_height_m = 0.05;
  EXPECT_THAT(PlanSurvey(bag, choice).mounting, HasSubstr("0.450 m"));
}

TEST(SurveyPlanTest, OdometryOfAnotherFrameIsMovedToTheBase) {
  BagSummary bag = Usual();
  bag.topics.back().child_frame_id = "wheel_axis";
  EXPECT_THAT(PlanSurvey(bag, {}).missing, ElementsAre(HasSubstr("is that of wheel_axis")));
  TransformSummary axis = Fixed("base_link", "wheel_axis", 0.0);
  axis.first.parent_from_child.translation().x() = 0.3;
  bag.transforms.push_back(axis);
  SurveyChoice choice;
  choice.base_frame = "base_link";
  const SurveyPlan plan = PlanSurvey(bag, choice);
  EXPECT_THAT(plan.missing, IsEmpty());
  EXPECT_NEAR(plan.odometry->child_from_base.translation().x(), -0.3, 1e-12);
}

TEST(SurveyPlanTest, OdometryMayBeATransform) {
  BagSummary bag = Usual();
  bag.topics.pop_back();
  TransformSummary moving = Fixed("odom", "base_link", 0.0);
  moving.messages = 100;
  moving.moves = true;
  moving.on_static_topic = false;
  bag.transforms.push_back(moving);
  const SurveyPlan plan = PlanSurvey(bag, {});
  ASSERT_TRUE(plan.odometry.has_value());
  EXPECT_EQ(plan.odometry->topic, "");
  EXPECT_EQ(plan.odometry->parent, "odom");
  SurveyChoice choice;
  choice.odom_frame = "elsewhere";
  EXPECT_THAT(PlanSurvey(bag, choice).missing,
              ElementsAre(HasSubstr("no moving transform from elsewhere to base_link")));
  choice.odom_frame.clear();
  choice.odom_topic = kNoTopic;
  EXPECT_FALSE(PlanSurvey(bag, choice).odometry.has_value());
}

TEST(SurveyPlanTest, TransformsThatMoveAreNoMounting) {
  BagSummary bag = Usual();
  bag.transforms[0].on_static_topic = false;
  bag.transforms[0].messages = 50;
  EXPECT_THAT(PlanSurvey(bag, {}).missing, IsEmpty());  // published again and again by ROS 1
  bag.transforms[0].moves = true;
  EXPECT_THAT(PlanSurvey(bag, {}).missing, ElementsAre(HasSubstr("nothing says how the camera hangs")));
}

TEST(SurveyPlanTest, ImagesOfAnotherSizeThanTheCalibrationAreRefused) {
  BagSummary bag = Usual();
  bag.topics[1].size_px = {320, 240};
  EXPECT_THAT(PlanSurvey(bag, {}).missing, ElementsAre(HasSubstr("are 320x240 but the calibration is for 640x480")));
}

TEST(SurveyPlanTest, TopicsThatCannotBeReadAreNotChosen) {
  BagSummary bag = Usual();
  bag.topics[2].problem = "topic /imu: a message ends too early";
  EXPECT_EQ(PlanSurvey(bag, {}).imu_topic, "");
  SurveyChoice choice;
  choice.imu_topic = "/imu";
  EXPECT_THAT(PlanSurvey(bag, choice).missing, ElementsAre("topic /imu: a message ends too early"));
}

}  // namespace
}  // namespace floorloc
