// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/unpack_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "tests/mapbuilder/bag/bag_file_support.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kMs = 1'000'000;

// The bags' camera is too small to see a floor: its floor.yaml is that of a larger one.
class UnpackBagTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    FloorPlane floor;
    floor.base_from_pixel << 0, -0.01, 0.3, -0.01, 0, 0.1, 0, 0, 1;
    floor.roi = {0.2, 0.25, -0.02, 0.02};
    floor.resolution_m = 0.002;
    choice_.floor_yaml = folder_.path() / "floor.yaml";
    WriteFileAtomically(choice_.floor_yaml, FormatFloorYaml(floor));
    choice_.image_topic = "/camera/image_raw/compressed";
  }
  UnpackedBag Unpack(const std::string& name) {
    const BagSummary bag = SummarizeBag(BagData(name));
    return UnpackBag(bag, PlanSurvey(bag, choice_), folder_.path() / "survey", {});
  }

  TemporaryFolder folder_;
  SurveyChoice choice_;
};

TEST_P(UnpackBagTest, GivesTheSurveyFolder) {
  const UnpackedBag unpacked = Unpack(GetParam());
  EXPECT_EQ(unpacked.frames, 3);
  EXPECT_EQ(unpacked.odometry, 4);
  EXPECT_EQ(unpacked.imu, 2);
  EXPECT_THAT(unpacked.warnings, ElementsAre("images: 1 were recorded after a later one; they were put in order"));
  const Survey survey = ReadSurvey(folder_.path() / "survey");
  std::vector<std::int64_t> stamps;
  std::vector<std::string> names;
  for (const SurveyFrame& frame : survey.frames) {
    stamps.push_back(frame.stamp_ns - kStart);
    names.push_back(frame.filename);
  }
  EXPECT_THAT(stamps, ElementsAre(100 * kMs, 200 * kMs, 300 * kMs));
  EXPECT_THAT(names, ElementsAre("images/000001.jpg", "images/000000.jpg", "images/000002.png"));
  EXPECT_EQ(survey.camera.camera.fx, 20);
  EXPECT_THAT(survey.camera.camera.distortion, ElementsAre(-0.1, 0.01, 0.001, -0.002, 0.003));
  EXPECT_EQ(survey.camera.camera.name, "camera_optical");
  EXPECT_EQ(survey.odometry.back().stamp_ns, kStart + 300 * kMs);
  EXPECT_EQ(survey.odometry.back().translation_m, Eigen::Vector3d(0.75, 0.5, 0));
  ASSERT_EQ(survey.imu.size(), 2U);
  EXPECT_TRUE(survey.imu[0].angular_velocity.isApprox(Eigen::Vector3d(-0.1, -0.2, 0.3), 1e-6));  // turned by pi
  EXPECT_EQ(ReadFloorOrigin(survey.folder), "floor.yaml");
}

INSTANTIATE_TEST_SUITE_P(Kinds, UnpackBagTest, ::testing::Values("zstd.mcap", "ros1.mcap", "lz4.bag", "split"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

using UnpackOneTest = UnpackBagTest;
INSTANTIATE_TEST_SUITE_P(One, UnpackOneTest, ::testing::Values("foxy.db3"));

TEST_P(UnpackOneTest, WritesPosesOfOtherTypesAndTransforms) {
  choice_.truth_topic = "/pose";
  choice_.odom_topic = "/amcl_pose";
  choice_.imu_topic = kNoTopic;
  Unpack(GetParam());
  const Survey survey = ReadSurvey(folder_.path() / "survey");
  EXPECT_EQ(survey.odometry.at(0).translation_m, Eigen::Vector3d(5, 6, 0));
  EXPECT_EQ(survey.ground_truth.at(0).translation_m, Eigen::Vector3d(3, 4, 0));
  EXPECT_TRUE(survey.imu.empty());
}

TEST_P(UnpackOneTest, LeavesNothingWhenSomethingIsMissing) {
  choice_.image_topic.clear();
  try {
    Unpack(GetParam());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("foxy.db3: has 2 topics of images (/camera/image_raw/compressed, /raw); choose one"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "survey"));
}

TEST_P(UnpackOneTest, RefusesAFolderThatIsNotEmpty) {
  WriteFileAtomically(folder_.path() / "survey", "");
  EXPECT_THROW(Unpack(GetParam()), InputError);
}

TEST_P(UnpackOneTest, SummarizesTopics) {
  const BagSummary bag = SummarizeBag(BagData(GetParam()));
  EXPECT_EQ(bag.messages, 24);
  EXPECT_EQ(bag.recorded.last_ns - bag.recorded.first_ns, 7000 * kMs);
  const TopicSummary* images = bag.Find("/camera/image_raw/compressed");
  ASSERT_NE(images, nullptr);
  EXPECT_EQ(images->messages, 3);
  EXPECT_EQ(images->out_of_order, 1);
  EXPECT_NEAR(images->longest_gap_s, 0.2, 1e-9);
  EXPECT_NEAR(images->RateHz(), 10.0, 1e-9);
  EXPECT_EQ(images->size_px, (std::array{16, 16}));
  EXPECT_EQ(bag.Find("/odom")->child_frame_id, "base_link");
  EXPECT_EQ(bag.Find("/chatter")->RateHz(), 0.0);
  EXPECT_EQ(bag.Find("/nothing"), nullptr);
  EXPECT_TRUE(bag.FixedFrames().Find("base_link", "camera_optical").has_value());
  EXPECT_EQ(bag.transforms.size(), 4U);
}

TEST(BagNameTest, HasNoEndings) {
  EXPECT_EQ(BagName("/data/drive_0.db3.zstd"), "drive_0");
  EXPECT_EQ(BagName("drive.bag.active"), "drive");
  EXPECT_EQ(BagName("2024.05.01.mcap"), "2024.05.01");
  EXPECT_EQ(BagName(BagData("split")), "split");
}

}  // namespace
}  // namespace floorloc
