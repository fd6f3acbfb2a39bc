// SPDX-License-Identifier: Apache-2.0
// Surveys taken from uneven heights: handheld, on a mast, by kite.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/mapbuilder/build/half_camera.h"
#include "tests/option_test_support.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class FreeHeightTest : public ::testing::Test {
 protected:
  FreeHeightTest() {
    static const TemporaryFolder recorded;
    static const int frames = [] {
      SimulateOptions options;
      options.out = recorded.path() / "survey";
      options.floor.source = "concrete";
      options.floor.width_m = 1.1;
      options.floor.height_m = 0.8;
      options.camera = HalfCamera();
      options.conditions.height_share = 0.15;
      options.path.overlap = 0.6;
      return Simulate(options).frames;
    }();
    frames_ = frames;
    std::filesystem::copy(recorded.path() / "survey", survey_, std::filesystem::copy_options::recursive);
    options_.surveys = {survey_};
    options_.out = folder_.path() / "floor.floormap";
    options_.hold_out = false;
  }

  // RMS distance of the frames' cameras from the ground truth after the best rigid motion or, with `any_scale`,
  // similarity.
  double RmsM(bool any_scale) const {
    const Survey survey = ReadSurvey(survey_);
    const Eigen::Vector2d below = survey.camera.CameraCenter().head<2>();
    std::vector<Eigen::Vector2d> found;
    std::vector<Eigen::Vector2d> truth;
    for (const MapFrame& frame : MapDatabase(options_.out).ReadFrames()) {
      found.push_back(frame.map_from_base * below);
      truth.push_back(*InterpolatePose(survey.ground_truth, frame.stamp_ns) * below);
    }
    Eigen::Matrix2Xd from(2, static_cast<Eigen::Index>(found.size()));
    Eigen::Matrix2Xd to = from;
    for (std::size_t i = 0; i < found.size(); ++i) {
      from.col(static_cast<Eigen::Index>(i)) = found[i];
      to.col(static_cast<Eigen::Index>(i)) = truth[i];
    }
    const Eigen::Matrix3d motion = Eigen::umeyama(from, to, any_scale);
    const Eigen::Matrix2Xd moved = (motion * from.colwise().homogeneous()).colwise().hnormalized();
    return std::sqrt((moved - to).squaredNorm() / static_cast<double>(found.size()));
  }

  TemporaryFolder folder_;
  std::filesystem::path survey_ = folder_.path() / "survey";
  BuildOptions options_;
  int frames_ = 0;
};

TEST_F(FreeHeightTest, IsTurnedOnByUnevenHeightsAndPlacesAllFrames) {
  const BuildReport report = BuildMap(options_);
  EXPECT_EQ(report.frames_used, frames_);
  EXPECT_TRUE(report.heights.free);
  EXPECT_NEAR(report.heights.highest / report.heights.lowest, 1.15 / 0.85, 0.05);
  EXPECT_EQ(report.heights.scale_by, "odometry");
  EXPECT_THAT(AllWarnings(report), Contains(AllOf(HasSubstr("differ by"), HasSubstr("each has its own"))));
  EXPECT_LT(RmsM(true), 0.002);
  EXPECT_LT(RmsM(false), 0.01) << "odometry tells the scale to a percent";
}

TEST_F(FreeHeightTest, ControlPointsTellTheScale) {
  const Survey survey = ReadSurvey(survey_);
  std::string csv = "filename,u,v,x,y\n";
  for (std::size_t i = 0; i < survey.frames.size(); i += 7) {
    // The principal point sees the floor below the camera from any height.
    const Eigen::Vector2d px(survey.camera.camera.cx, survey.camera.camera.cy);
    const Pose2 pose = *InterpolatePose(survey.ground_truth, survey.frames[i].stamp_ns);
    const Eigen::Vector2d p = 1.03 * (pose * survey.camera.CameraCenter().head<2>());
    csv += survey.frames[i].filename + "," + std::to_string(px.x()) + "," + std::to_string(px.y()) + "," +
           std::to_string(p.x()) + "," + std::to_string(p.y()) + "\n";
  }
  WriteFileAtomically(survey_ / "control_points.csv", csv);
  const BuildReport report = BuildMap(options_);
  EXPECT_EQ(report.heights.scale_by, "control points and known distances");
  EXPECT_EQ(report.frames_used, frames_);
  for (const ControlPointError& point : report.control_points) {
    EXPECT_LT((point.surveyed_m - point.observed_m).norm(), 0.004);
  }
}

TEST_F(FreeHeightTest, TurnedOffItSaysWhatHelps) {
  options_.heights.mode = FreeHeight::kOff;
  options_.placement.keep_all = true;
  const BuildReport report = BuildMap(options_);
  EXPECT_FALSE(report.heights.free);
  EXPECT_GT(report.heights.spread, 0.1);
  EXPECT_THAT(AllWarnings(report),
              Contains(AllOf(HasSubstr("in height; floorloc assumes one height"), HasSubstr("use --free-height"))));
  EXPECT_GT(RmsM(true), 0.004) << "else nothing is gained by free heights";
  const BuildReport parsed = ParseBuildReport(ToJson(report, false));
  EXPECT_EQ(parsed.heights.spread, report.heights.spread);
}

TEST_F(FreeHeightTest, FindsAnOrderWhereThereIsNone) {
  const std::vector<SurveyFrame> frames = ReadSurvey(survey_).frames;
  std::string csv = "timestamp,filename\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    csv += std::to_string(100 + i) + "," + frames[i * 17 % frames.size()].filename + "\n";
  }
  WriteFileAtomically(survey_ / "frames.csv", csv);
  std::filesystem::remove(survey_ / "odometry.tum");
  std::filesystem::remove(survey_ / "groundtruth.tum");
  const BuildReport report = BuildMap(options_);
  EXPECT_TRUE(report.heights.free);
  EXPECT_EQ(report.frames_used, frames_);
  EXPECT_THAT(report.heights.scale_by, HasSubstr("the calibrated height"));
}

TEST(FreeHeightOptionsTest, AreChecked) {
  OptionTable<FrameHeightOptions>()
      .Refuses("max_spread", &FrameHeightOptions::max_spread, {0.0, 1.0})
      .Refuses("sampled_pairs", &FrameHeightOptions::sampled_pairs, {0})
      .Refuses("searched_frames", &FrameHeightOptions::searched_frames, {1})
      .Refuses("min_uneven_pairs", &FrameHeightOptions::min_uneven_pairs, {0})
      .Refuses("keypoints", &FrameHeightOptions::keypoints, {1})
      .Refuses("pairs_per_frame", &FrameHeightOptions::pairs_per_frame, {0});
  EXPECT_EQ(ParseFreeHeight("on"), FreeHeight::kOn);
  EXPECT_THROW(ParseFreeHeight("yes"), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
