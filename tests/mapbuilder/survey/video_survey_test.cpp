// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/video_survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/build/build_map.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kFps = 10.0;

// A robot drives 0.5 m straight with a standstill in between; ten images per second.
class VideoSurveyTest : public ::testing::Test {
 protected:
  VideoSurveyTest() {
    WriteFileAtomically(folder_.path() / "camera.yaml", FormatCameraYaml(floor_.camera().camera));
    WriteFileAtomically(folder_.path() / "floor.yaml", FormatFloorYaml(floor_.camera().floor));
    options_.video = folder_.path() / "drive.avi";
    options_.camera_yaml = folder_.path() / "camera.yaml";
    options_.floor_yaml = folder_.path() / "floor.yaml";
    options_.out = folder_.path() / "made" / "survey";
    options_.start_s = 1000.0;
  }

  Pose2 PoseAt(int image) const {
    const int moved = image < 10 ? image : std::max(10, image - 10);  // standing from 10 to 20
    return floor_.BaseForView(0.3 + 0.02 * moved, 0.45, 0.01 * moved);
  }

  // Odd images are blurred.
  void WriteVideo(int images) const {
    cv::VideoWriter video(options_.video.string(), cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                          kFps, {640, 480});
    ASSERT_TRUE(video.isOpened());
    for (int i = 0; i < images; ++i) {
      RenderConditions conditions;
      conditions.read_noise = 1.5;
      conditions.noise_seed = static_cast<std::uint64_t>(i) + 1;
      cv::Mat image = floor_.View(PoseAt(i), conditions);
      if (i % 2 == 1) {
        cv::GaussianBlur(image, image, {}, 2.0);
      }
      video.write(image);
    }
  }

  std::string Error() {
    try {
      WriteVideoSurvey(options_);
    } catch (const InputError& error) {
      EXPECT_FALSE(fs::exists(options_.out.parent_path()));
      return error.what();
    }
    return "written";
  }

  TemporaryFolder folder_;
  static const SyntheticFloor& Floor() {
    static const SyntheticFloor floor;
    return floor;
  }
  const SyntheticFloor& floor_ = Floor();
  VideoSurveyOptions options_;
};

TEST_F(VideoSurveyTest, TakesTheSharpestOfEachSpanAndNoStandstill) {
  WriteVideo(34);
  const VideoSurveyResult result = WriteVideoSurvey(options_);
  EXPECT_EQ(result.frames_read, 34);
  EXPECT_TRUE(result.warnings.empty());
  std::vector<double> times_s;
  for (const SurveyFrame& frame : ReadSurvey(options_.out).frames) {
    times_s.push_back(ToSeconds(frame.stamp_ns) - 1000.0);
  }
  std::vector<::testing::Matcher<double>> expected;
  for (const double time_s : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 2.2, 2.4, 2.6, 2.8, 3.0, 3.2}) {
    expected.push_back(::testing::DoubleNear(time_s, 1e-6));
  }
  EXPECT_THAT(times_s, ::testing::ElementsAreArray(expected));
}

TEST_F(VideoSurveyTest, TheMapIsTrue) {
  WriteVideo(34);
  WriteVideoSurvey(options_);
  BuildOptions build;
  build.surveys = {options_.out};
  build.out = folder_.path() / "map.floormap";
  build.mosaic.resolution_m = 0.0028;
  EXPECT_EQ(BuildMap(build).frames_used, 12);
  std::vector<OrientedMatch> pairs;
  std::vector<int> all;
  const Eigen::Vector2d middle = floor_.camera().floor.roi.Center();
  for (const MapFrame& frame : MapDatabase(build.out).ReadFrames()) {
    const int image = static_cast<int>(std::lround(kFps * (ToSeconds(frame.stamp_ns) - 1000.0)));
    pairs.push_back({frame.map_from_base * middle, PoseAt(image) * middle, 0.0, 0.0});
    all.push_back(static_cast<int>(all.size()));
  }
  EXPECT_LT(RmsResidual(pairs, all, FitRigid(pairs, all).value()), 5e-4);
}

TEST_F(VideoSurveyTest, OdometryComesAlong) {
  WriteVideo(4);
  options_.odometry = folder_.path() / "wheels.tum";
  WriteFileAtomically(options_.odometry, "1000 0 0 0 0 0 0 1\n1001 0.2 0 0 0 0 0 1\n");
  WriteVideoSurvey(options_);
  EXPECT_EQ(ReadSurvey(options_.out).odometry.size(), 2U);
}

TEST_F(VideoSurveyTest, AnotherSizeIsRefused) {
  WriteVideo(2);
  CameraModel other = floor_.camera().camera;
  other.width_px = 1280;
  WriteFileAtomically(options_.camera_yaml, FormatCameraYaml(other));
  EXPECT_THAT(Error(), AllOf(HasSubstr("drive.avi: the images are 640x480"), HasSubstr("says 1280x480")));
}

TEST_F(VideoSurveyTest, WhatIsNoVideoIsRefused) {
  EXPECT_THAT(Error(), HasSubstr("drive.avi: is not a file"));
  std::ofstream(options_.video) << "no video";
  EXPECT_THAT(Error(), HasSubstr("drive.avi: is no video that can be read"));
}

TEST_F(VideoSurveyTest, AVideoWithoutImagesIsRefused) {
  WriteVideo(0);
  EXPECT_THAT(Error(), HasSubstr("drive.avi: "));
}

TEST_F(VideoSurveyTest, ACutVideoIsNamed) {
  WriteVideo(20);
  fs::resize_file(options_.video, fs::file_size(options_.video) / 2);
  const std::string error = [&]() -> std::string {
    try {
      const VideoSurveyResult result = WriteVideoSurvey(options_);
      return result.warnings.empty() ? "silent" : result.warnings.front();
    } catch (const InputError& refused) {
      return refused.what();
    }
  }();
  EXPECT_THAT(error, HasSubstr("drive.avi: "));
}

TEST_F(VideoSurveyTest, NonsenseOptionsAreRefused) {
  options_.step_s = 0.0;
  EXPECT_THROW(WriteVideoSurvey(options_), std::invalid_argument);
}

TEST_F(VideoSurveyTest, FindsTheVideoOfAFolder) {
  EXPECT_EQ(FindVideo(folder_.path()), fs::path());
  std::ofstream(folder_.path() / "video.mp4") << "x";
  EXPECT_EQ(FindVideo(folder_.path()), folder_.path() / "video.mp4");
  std::ofstream(folder_.path() / "frames.csv") << "x";
  EXPECT_EQ(FindVideo(folder_.path()), fs::path()) << "a survey of images";
}

}  // namespace
}  // namespace floorloc
