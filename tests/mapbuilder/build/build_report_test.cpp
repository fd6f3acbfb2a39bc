// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_error.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

BuildReport MakeReport() {
  BuildReport report;
  report.frames = 30;
  report.frames_used = 28;
  report.dropped = {{"images/3.jpg", "no texture", Pose2(1.0, 2.0, 0.5)}, {"images/4.jpg", "blurred"}};
  report.warnings = {"camera.yaml has not this survey's camera"};
  report.part_sizes = {28};
  report.repeats_unaided = true;
  report.links = 77;
  report.overlapping_pairs = 50;
  report.unmatched_pairs = 1;
  report.drift_m = 0.125;
  report.extent = {-1.0, 2.0, 0.0, 4.0};
  report.camera_doubt = {2e-4, 5e-4, 1.5e-3, 3.5};
  report.keypoints = 12345;
  report.held_out = {{"images/7.jpg", Pose2(0.5, 0.25, 3.0), "wrong", "", 0.5, 0.25, 300, 40},
                     {"images/9.jpg", Pose2(), "not_localized", "too_few_inliers", 0.0, 0.0, 20, 3}};
  report.control_points = {{"images/1.jpg", Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(1.5, 2.25)}};
  report.masks = {{CameraMaskStatus::kFound, true, 0.125, 20, {}, {}},
                  {CameraMaskStatus::kUndecided, false, 0.0, 2, {}, {}}};
  report.markers = {{7, true, true, 3, 0.002}, {9, false, false, 2, 0.0}};
  report.flat_fields = {{2, 1, {1.0, 1.5}}};
  report.total_s = 12.5;
  return report;
}

TEST(BuildReportTest, WhatAMapKeepsOfItIsReadBack) {
  const BuildReport report = MakeReport();
  const std::string text = ToJson(report, false);
  const BuildReport read = ParseBuildReport(text);
  EXPECT_EQ(ToJson(read, false), text);
  EXPECT_EQ(read.dropped.at(0).near.value().yaw(), 0.5);
  EXPECT_FALSE(read.dropped.at(1).near.has_value());
  EXPECT_EQ(read.held_out.at(0).error_m, 0.5);
  EXPECT_EQ(read.held_out.at(1).reason, "too_few_inliers");
  EXPECT_TRUE(read.repeats_unaided);
  EXPECT_EQ(read.camera_doubt.pose_rms_m, 1.5e-3);
  EXPECT_EQ(read.camera_doubt.camera_px, 3.5);
  EXPECT_EQ(read.markers.at(0).error_m, 0.002);
  EXPECT_EQ(read.masks.at(0).status, CameraMaskStatus::kFound);
  EXPECT_EQ(read.masks.at(0).share, 0.125);
  EXPECT_EQ(read.masks.at(1).pairs, 2);
  EXPECT_EQ(read.control_points.at(0).observed_m.y(), 2.25);
  EXPECT_THAT(read.flat_fields.at(0).gain, ElementsAre(1.0, 1.5));
}

TEST(BuildReportTest, TimesAreNoContentOfAMap) {
  EXPECT_THAT(ToJson(MakeReport(), false), Not(HasSubstr("total_s")));
  EXPECT_THAT(ToJson(MakeReport(), true), HasSubstr("\"total_s\": 12.5"));
}

TEST(BuildReportTest, WhatAnOlderBuilderDidNotWriteIsEmpty) {
  const BuildReport read = ParseBuildReport(R"({"frames": 3})");
  EXPECT_EQ(read.frames, 3);
  EXPECT_THAT(read.held_out, IsEmpty());
}

TEST(BuildReportTest, ADamagedReportIsRefused) {
  for (const char* text : {"", "[", "[]", R"({"frames": "many"})", R"({"dropped": [{"filename": 3}]})",
                           R"({"flat_fields": [{"columns": 3, "rows": 2, "gain": [1.0]}]})"}) {
    EXPECT_THROW(ParseBuildReport(text), MapError) << text;
  }
}

TEST(BuildReportTest, WithoutLinksThereIsNoResidual) {
  BuildReport report = MakeReport();
  EXPECT_THAT(ToText(report), HasSubstr("links        77 (0 contradicted the rest), residual 0.00 mm"));
  report.links = 0;
  report.rejected_links = 6;
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("links        none: all 6 that the images gave contradict the poses"),
                                    Not(HasSubstr("residual"))));
  report.rejected_links = 0;
  EXPECT_THAT(ToText(report), HasSubstr("links        none: no images show the same floor"));
}

TEST(BuildReportTest, WarningsNameGapsAndPairsThatDoNotMatch) {
  BuildReport report = MakeReport();
  report.warnings = {"one from the door"};
  EXPECT_THAT(AllWarnings(report), ElementsAre("one from the door"));
  report.part_sizes = {20, 8};
  report.unmatched_pairs = 6;
  EXPECT_THAT(AllWarnings(report),
              ElementsAre("one from the door", HasSubstr("2 parts that do not connect (20, 8 frames)"),
                          HasSubstr("6 of 50 pairs")));
  EXPECT_THAT(ToText(report), HasSubstr("WARNING      6 of 50 pairs"));
}

}  // namespace
}  // namespace floorloc
