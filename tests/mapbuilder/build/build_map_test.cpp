// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iomanip>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BuildMapTest : public ::testing::Test {
 protected:
  BuildMapTest() {
    static const TemporaryFolder recorded;
    static const SyntheticFloor floor(1);
    static const bool written = floor.WriteSurvey(recorded.path() / "survey").frames > 0;
    EXPECT_TRUE(written);
    fs::copy(recorded.path() / "survey", survey_, fs::copy_options::recursive);
    truth_ = ReadTum(survey_ / "groundtruth.tum");
    options_.surveys = {survey_};
    options_.out = folder_.path() / "floor.floormap";
    options_.mosaic.resolution_m = 0.0028;  // coarse is fast
  }

  BuildReport Build() { return BuildMap(options_); }
  std::vector<MapFrame> Frames() const { return MapDatabase(options_.out).ReadFrames(); }

  // Pairs of the estimated and the true map position of each frame's centre.
  std::vector<OrientedMatch> ViewPairs(const std::vector<MapFrame>& frames) const {
    const Eigen::Vector2d center = ReadSurvey(survey_).camera.floor.roi.Center();
    std::vector<OrientedMatch> pairs;
    for (const MapFrame& frame : frames) {
      for (const StampedPose3& row : truth_) {
        if (row.stamp_ns == frame.stamp_ns) {
          pairs.push_back({frame.map_from_base * center, row.ToPose2() * center, 0.0, 0.0});
        }
      }
    }
    return pairs;
  }
  static double RmsAfterAlignment(const std::vector<OrientedMatch>& pairs) {
    std::vector<int> all(pairs.size());
    std::iota(all.begin(), all.end(), 0);
    return RmsResidual(pairs, all, FitRigid(pairs, all).value());
  }
  static double RmsAsIs(const std::vector<OrientedMatch>& pairs) {
    std::vector<int> all(pairs.size());
    std::iota(all.begin(), all.end(), 0);
    return RmsResidual(pairs, all, Pose2());
  }

  // Keeps the frames whose centre passes the test, and removes the odometry.
  void KeepViews(const std::function<bool(const Eigen::Vector2d&)>& keep) {
    const Survey survey = ReadSurvey(survey_);
    std::string csv = "timestamp,filename\n";
    for (const SurveyFrame& frame : survey.frames) {
      const Pose2 pose = InterpolatePose(survey.ground_truth, frame.stamp_ns).value();
      if (keep(pose * survey.camera.floor.roi.Center())) {
        csv += FormatSeconds(frame.stamp_ns) + "," + frame.filename + "\n";
      }
    }
    WriteFileAtomically(survey_ / "frames.csv", csv);
    fs::remove(survey_ / "odometry.tum");
  }

  TemporaryFolder folder_;
  fs::path survey_ = folder_.path() / "survey";
  Trajectory truth_;
  BuildOptions options_;
};

TEST_F(BuildMapTest, WithOdometryTheGeometryIsTrue) {
  const BuildReport report = Build();
  EXPECT_EQ(report.frames, 28);
  EXPECT_EQ(report.frames_used, 28);
  EXPECT_TRUE(report.dropped.empty());
  EXPECT_EQ(report.part_sizes, std::vector<int>{28});
  EXPECT_GT(report.drift_m, 1e-3);
  EXPECT_NEAR(report.area_m2, 1.2 * 0.9, 0.1);
  EXPECT_GT(report.keypoints, 2000);
  EXPECT_GT(report.mean_observations, 1.5);
  const auto pairs = ViewPairs(Frames());
  ASSERT_EQ(pairs.size(), 28U);
  EXPECT_LT(RmsAfterAlignment(pairs), 1e-3);
  // The map's frame is the odometry frame of the first frame.
  const Pose2 first = Frames().front().map_from_base;
  const Pose2 odometry = ReadTum(survey_ / "odometry.tum").front().ToPose2();
  EXPECT_LT((first.translation() - odometry.translation()).norm(), 1e-9);
  EXPECT_NEAR(first.yaw(), odometry.yaw(), 1e-9);
}

// Another camera, another resolution, another day: only images connect the sessions.
TEST_F(BuildMapTest, SessionsOfSeveralCamerasMakeOneMap) {
  SimulateOptions second = SyntheticFloor(1).SurveyOptions(folder_.path() / "second");
  second.camera = MakeForwardCamera();
  second.seed += 1;
  ASSERT_GT(Simulate(second).frames, 0);
  options_.surveys.push_back(second.out);
  const BuildReport report = Build();
  EXPECT_EQ(report.frames_used, report.frames);
  EXPECT_EQ(report.part_sizes.size(), 1U);
  const Trajectory truths[] = {truth_, ReadTum(second.out / "groundtruth.tum")};
  std::vector<OrientedMatch> pairs;
  for (const MapFrame& frame : Frames()) {
    const auto truth = InterpolatePose(truths[frame.survey], frame.stamp_ns);
    ASSERT_TRUE(truth);
    pairs.push_back({frame.map_from_base.translation(), truth->translation(), 0.0, 0.0});
  }
  EXPECT_GT(pairs.size(), 28U);
  EXPECT_LT(RmsAfterAlignment(pairs), 2e-3);
}

TEST_F(BuildMapTest, TheMapIsWholeAndConsistentWithItsReport) {
  options_.mosaic.resolution_m = 0.0;  // the survey's
  const BuildReport report = Build();
  const MapDatabase database(options_.out);
  database.VerifyContent();
  EXPECT_EQ(database.ReadMosaicLayout().resolution_m, ReadSurvey(survey_).camera.floor.resolution_m);
  const FloorMap map = database.ReadMap();
  EXPECT_EQ(map.info.content_version, report.content_version);
  EXPECT_EQ(static_cast<int>(map.keypoints.size()), report.keypoints);
  EXPECT_EQ(map.info.name, "floor");
  EXPECT_EQ(map.info.area_m2, report.area_m2);
  EXPECT_THAT(map.info.surveys_json, HasSubstr("\"frames\":28"));
  const MosaicImage mosaic = ExportMosaic(database, 0.0);
  EXPECT_NEAR(mosaic.bgr.cols * mosaic.resolution_m, mosaic.extent.width_m(), 1e-9);
  EXPECT_LE(mosaic.extent.x_min, map.info.extent.x_min + 1e-9);
  EXPECT_GE(mosaic.extent.y_max, map.info.extent.y_max - 1e-9);
  EXPECT_NEAR(ExportMosaic(database, 0.005).resolution_m, 0.005, 1e-4);
}

TEST_F(BuildMapTest, WithoutOdometryTheGeometryIsTrue) {
  fs::remove(survey_ / "odometry.tum");
  const BuildReport report = Build();
  EXPECT_EQ(report.frames_used, 28);
  EXPECT_EQ(report.drift_m, 0.0);
  EXPECT_LT(RmsAfterAlignment(ViewPairs(Frames())), 1e-3);
  EXPECT_LT(Frames().front().map_from_base.translation().norm(), 1e-9);  // identity without odometry
}

TEST_F(BuildMapTest, AFolderOfPhotographsIsEnough) {
  for (const char* name : {"odometry.tum", "frames.csv", "groundtruth.tum"}) {
    fs::remove(survey_ / name);
  }
  const BuildReport report = Build();
  EXPECT_EQ(report.frames_used, 28);
  std::vector<MapFrame> frames = Frames();
  ASSERT_EQ(frames.size(), truth_.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].stamp_ns = truth_[i].stamp_ns;
  }
  EXPECT_LT(RmsAfterAlignment(ViewPairs(frames)), 1e-3);
}

TEST_F(BuildMapTest, KnownPosesGiveTheMapTheirFrame) {
  options_.poses = truth_;
  options_.placement.prior_sigma_m = 0.005;
  options_.placement.prior_sigma_rad = 0.005;
  Build();
  EXPECT_LT(RmsAsIs(ViewPairs(Frames())), 1e-3);
}

TEST_F(BuildMapTest, ControlPointsGiveTheMapTheirFrame) {
  const Survey survey = ReadSurvey(survey_);
  std::ostringstream csv;
  csv << "filename,u,v,x,y\n" << std::setprecision(12);
  for (const std::size_t i : {0U, 6U, 21U, 27U}) {
    const Eigen::Vector2d raw_px(300.0, 260.0);
    const Pose2 pose = InterpolatePose(survey.ground_truth, survey.frames[i].stamp_ns).value();
    const Eigen::Vector2d p = pose * survey.camera.FloorFromRawPixel(raw_px);
    csv << survey.frames[i].filename << "," << raw_px.x() << "," << raw_px.y() << "," << p.x() << "," << p.y() << "\n";
  }
  WriteFileAtomically(survey_ / "control_points.csv", csv.str());
  Build();
  EXPECT_LT(RmsAsIs(ViewPairs(Frames())), 1e-3);
}

TEST_F(BuildMapTest, OneControlPointIsRefused) {
  WriteFileAtomically(survey_ / "control_points.csv", "filename,u,v,x,y\nimages/000000.jpg,300,200,0.1,0.1\n");
  EXPECT_THROW(Build(), InputError);
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(BuildMapTest, AGapLeavesTheLargerPart) {
  KeepViews([](const Eigen::Vector2d& view) { return view.x() < 0.5 || view.x() > 0.8; });
  const BuildReport report = Build();
  EXPECT_EQ(report.frames, 20);
  EXPECT_EQ(report.part_sizes, (std::vector<int>{12, 8}));
  EXPECT_EQ(report.frames_used, 12);
  ASSERT_EQ(report.dropped.size(), 8U);
  EXPECT_EQ(report.dropped.front().reason, "not connected to the largest part");
  const auto pairs = ViewPairs(Frames());
  ASSERT_EQ(pairs.size(), 12U);
  for (const OrientedMatch& pair : pairs) {
    EXPECT_LT(pair.target_m.x(), 0.5);
  }
  EXPECT_LT(RmsAfterAlignment(pairs), 1e-3);
}

TEST_F(BuildMapTest, KeepAllKeepsBothPartsSideBySide) {
  KeepViews([](const Eigen::Vector2d& view) { return view.x() < 0.5 || view.x() > 0.8; });
  options_.placement.keep_all = true;
  const BuildReport report = Build();
  EXPECT_EQ(report.frames_used, 20);
  EXPECT_EQ(report.part_sizes, (std::vector<int>{12, 8}));
  std::vector<OrientedMatch> left;
  std::vector<OrientedMatch> right;
  for (const OrientedMatch& pair : ViewPairs(Frames())) {
    (pair.target_m.x() < 0.65 ? left : right).push_back(pair);
  }
  ASSERT_EQ(left.size(), 12U);
  ASSERT_EQ(right.size(), 8U);
  EXPECT_LT(RmsAfterAlignment(left), 1e-3);
  EXPECT_LT(RmsAfterAlignment(right), 1e-3);
  double nearest_m = 100.0;
  for (const OrientedMatch& a : left) {
    for (const OrientedMatch& b : right) {
      nearest_m = std::min(nearest_m, (a.source_m - b.source_m).norm());
    }
  }
  EXPECT_GT(nearest_m, 0.5) << "parts of unknown relation must not overlap";
}

TEST_F(BuildMapTest, EveryThreadCountGivesTheSameMap) {
  options_.run.threads = 1;
  const std::string version = Build().content_version;
  for (const int threads : {1, 2, 5}) {
    options_.run.threads = threads;
    EXPECT_EQ(Build().content_version, version) << threads;
  }
}

TEST_F(BuildMapTest, ASlashAfterTheSurveyMakesNoOtherMap) {
  const std::string version = Build().content_version;
  options_.surveys = {survey_ / ""};
  EXPECT_EQ(Build().content_version, version);
  EXPECT_THAT(MapDatabase(options_.out).ReadInfo().surveys_json,
              HasSubstr("\"folder\":\"" + survey_.filename().string() + "\""));
}

TEST_F(BuildMapTest, EveryExtractorBuildsAMap) {
  for (const ExtractorType type : AllExtractorTypes()) {
    options_.extractor.type = type;
    const BuildReport report = Build();
    EXPECT_EQ(report.frames_used, 28) << ToString(type);
    EXPECT_LT(RmsAfterAlignment(ViewPairs(Frames())), 1e-3) << ToString(type);
    EXPECT_EQ(MapDatabase(options_.out).ReadInfo().extractor.type, type);
  }
}

TEST_F(BuildMapTest, TwoSurveysOfOneFloorBecomeOneMap) {
  options_.surveys = {survey_, folder_.path() / "second"};
  SimulateOptions second = SyntheticFloor(1).SurveyOptions(options_.surveys[1]);
  second.seed = 99;  // different light and drift
  Simulate(second);
  fs::remove(options_.surveys[1] / "odometry.tum");
  const BuildReport report = Build();
  EXPECT_EQ(report.frames, 56);
  EXPECT_EQ(report.frames_used, 56);
  EXPECT_NEAR(report.area_m2, 1.2 * 0.9, 0.1);
}

TEST_F(BuildMapTest, AFailedBuildKeepsTheOldMap) {
  const std::string version = Build().content_version;
  for (const char* name : {"000012.jpg", "000013.jpg"}) {
    std::ofstream(survey_ / "images" / name) << "no image";
  }
  try {
    Build();
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("000012.jpg"));
  }
  EXPECT_EQ(MapDatabase(options_.out).ReadInfo().content_version, version);
  EXPECT_FALSE(fs::exists(options_.out.string() + ".part"));
}

TEST_F(BuildMapTest, AnImageWithoutTextureIsDropped) {
  cv::imwrite((survey_ / "images" / "000013.jpg").string(), cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(128)));
  for (const bool with_odometry : {true, false}) {
    if (!with_odometry) {
      fs::remove(survey_ / "odometry.tum");
    }
    const BuildReport report = Build();
    EXPECT_EQ(report.frames_used, 27);
    ASSERT_EQ(report.dropped.size(), 1U);
    EXPECT_EQ(report.dropped[0].filename, "images/000013.jpg");
    EXPECT_EQ(report.dropped[0].reason, "no texture");
  }
}

TEST_F(BuildMapTest, ImagesWithoutAnyTextureAreRefused) {
  for (const fs::directory_entry& image : fs::directory_iterator(survey_ / "images")) {
    cv::imwrite(image.path().string(), cv::Mat::zeros(480, 640, CV_8UC3));
  }
  EXPECT_THROW(Build(), InputError);
  fs::remove(survey_ / "odometry.tum");
  EXPECT_THROW(Build(), InputError);
  EXPECT_FALSE(fs::exists(options_.out));
}

TEST_F(BuildMapTest, PosesOfAnotherClockAreRefused) {
  options_.poses = truth_;
  for (StampedPose3& row : options_.poses) {
    row.stamp_ns += 1'000'000'000'000;
  }
  EXPECT_THROW(Build(), InputError);
}

TEST_F(BuildMapTest, UnrelatedImagesAreRefused) {
  KeepViews([](const Eigen::Vector2d& view) {
    return (view - Eigen::Vector2d(0.17, 0.22)).norm() < 0.05 || (view - Eigen::Vector2d(1.03, 0.68)).norm() < 0.05;
  });
  EXPECT_THROW(Build(), InputError);
  EXPECT_FALSE(fs::exists(options_.out));
}

}  // namespace
}  // namespace floorloc
