// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/markers/markers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/fiducials/aruco_dictionary.h"
#include "mapbuilder/markers/marker_positions.h"
#include "mapbuilder/simulation/camera_renderer.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kMarkerM = 0.04;
constexpr double kRimM = 0.01;

// A marker on the test floor, rotated counter-clockwise in steps of 90 degrees.
struct PlacedMarker {
  int id = 0;
  Eigen::Vector2d center_m;
  int quarter_turns = 0;
};

const std::vector<PlacedMarker> kPlacedMarkers{
    {3, {0.30, 0.25}, 0}, {7, {0.90, 0.25}, 1}, {11, {0.90, 0.65}, 0}, {20, {0.30, 0.65}, 2}, {31, {0.60, 0.45}, 0}};
// Marker 31 is not in the file.
const char* const kTrueCsv = "id,x,y,yaw\n3,0.30,0.25,\n7,0.90,0.25,\n11,0.90,0.65,\n20,0.30,0.65,\n";

void DrawMarkers(FloorTexture* floor) {
  const auto dictionary = FindArucoDictionary("DICT_4X4_50");
  const int side = static_cast<int>(std::lround(kMarkerM / floor->resolution_m));
  const int rim = static_cast<int>(std::lround(kRimM / floor->resolution_m));
  for (const PlacedMarker& placed : kPlacedMarkers) {
    cv::Mat marker;
    cv::aruco::drawMarker(dictionary, placed.id, side, marker);
    cv::copyMakeBorder(marker, marker, rim, rim, rim, rim, cv::BORDER_CONSTANT, cv::Scalar(255));
    for (int i = 0; i < placed.quarter_turns; ++i) {
      cv::rotate(marker, marker, cv::ROTATE_90_COUNTERCLOCKWISE);
    }
    marker = 0.7 * marker + 20.0;
    cv::cvtColor(marker, marker, cv::COLOR_GRAY2BGR);
    // The marker's centre is on a pixel border.
    const Eigen::Vector2d px = floor->PixelFromMap(placed.center_m) + Eigen::Vector2d(0.5, 0.5);
    const int half = side / 2 + rim;
    marker.copyTo(floor->bgr(cv::Rect(static_cast<int>(std::lround(px.x())) - half,
                                      static_cast<int>(std::lround(px.y())) - half, marker.cols, marker.rows)));
  }
}

FloorTexture MarkedFloor() {
  FloorTextureOptions options;
  options.width_m = 1.2;
  options.height_m = 0.9;
  FloorTexture floor = MakeFloorTexture(options);
  DrawMarkers(&floor);
  return floor;
}

// 18 frames over a floor with five markers; odometry without drift, in its own frame.
void WriteSurvey(const fs::path& folder) {
  const FloorTexture floor = MarkedFloor();
  const FloorCamera camera = MakeDownwardCamera();
  const CameraRenderer renderer(floor, camera);
  fs::create_directories(folder / "images");
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(camera.camera));
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(camera.floor));
  std::ostringstream frames("timestamp,filename\n", std::ios::ate);
  std::ostringstream truth;
  std::ostringstream odometry;
  const Pose2 odom_from_map(3.0, -2.0, 0.4);
  const auto write_pose = [](int stamp, const Pose2& p, std::ostream& out) {
    out << stamp << " " << p.x() << " " << p.y() << " 0 0 0 " << std::sin(0.5 * p.yaw()) << " "
        << std::cos(0.5 * p.yaw()) << "\n";
  };
  for (int i = 0; i < 18; ++i) {
    const int strip = i / 3;
    const double x = 0.25 + 0.14 * strip;
    const double y = 0.25 + 0.2 * (strip % 2 == 0 ? i % 3 : 2 - i % 3);
    const Eigen::Vector2d center = camera.floor.roi.Center();
    const Pose2 pose = Pose2(x, y, 0.03 * i) * Pose2(-center.x(), -center.y(), 0.0);
    const std::string name = "images/" + std::to_string(100 + i) + ".png";
    cv::imwrite((folder / name).string(), renderer.Render(pose, {}));
    frames << i << "," << name << "\n";
    write_pose(i, pose, truth);
    write_pose(i, odom_from_map * pose, odometry);
  }
  WriteFileAtomically(folder / "frames.csv", frames.str());
  WriteFileAtomically(folder / "groundtruth.tum", truth.str());
  WriteFileAtomically(folder / "odometry.tum", odometry.str());
}

class MarkersTest : public ::testing::Test {
 protected:
  MarkersTest() {
    static const TemporaryFolder recorded;
    static const bool written = (WriteSurvey(recorded.path()), true);
    EXPECT_TRUE(written);
    truth_ = ReadTum(recorded.path() / "groundtruth.tum");
    options_.surveys = {recorded.path()};
    options_.out = folder_.path() / "floor.floormap";
    options_.mosaic.resolution_m = 0.0028;  // coarse is fast
    options_.markers.detection.size_m = kMarkerM;
  }

  BuildReport Build(const std::string& csv) {
    options_.markers.file = folder_.path() / "markers.csv";
    WriteFileAtomically(options_.markers.file, csv);
    return BuildMap(options_);
  }
  std::string Error(const std::string& csv) {
    try {
      Build(csv);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  double WorstPoseErrorM() const {
    const Eigen::Vector2d center = MakeDownwardCamera().floor.roi.Center();
    double worst = 0.0;
    const std::vector<MapFrame> frames = MapDatabase(options_.out).ReadFrames();
    EXPECT_EQ(frames.size(), truth_.size());
    for (std::size_t i = 0; i < std::min(frames.size(), truth_.size()); ++i) {
      worst = std::max(worst, (frames[i].map_from_base * center - truth_[i].ToPose2() * center).norm());
    }
    return worst;
  }

  int KeypointsOnMarkers() const {
    int count = 0;
    for (const Keypoint& keypoint : MapDatabase(options_.out).ReadMap().keypoints.keypoints) {
      for (const PlacedMarker& placed : kPlacedMarkers) {
        const double reach = 0.5 * kMarkerM + kRimM;
        count += (keypoint.Position() - placed.center_m).lpNorm<Eigen::Infinity>() < reach ? 1 : 0;
      }
    }
    return count;
  }

  TemporaryFolder folder_;
  Trajectory truth_;
  BuildOptions options_;
};

TEST_F(MarkersTest, TheMapComesOutInTheMarkersFrameAndHoldsNoneOfThem) {
  const BuildReport report = Build(kTrueCsv);
  EXPECT_LT(WorstPoseErrorM(), 1e-3);
  EXPECT_EQ(KeypointsOnMarkers(), 0);
  ASSERT_EQ(report.markers.size(), 5u);
  for (const MarkerFit& fit : report.markers) {
    EXPECT_EQ(fit.known, fit.id != 31);
    EXPECT_EQ(fit.used, fit.known);
    EXPECT_GE(fit.frames, 1) << fit.id;
    EXPECT_LT(fit.error_m, 1e-3) << fit.id;
  }
  EXPECT_THAT(report.warnings, Contains(HasSubstr("marker 31 is in")));
}

TEST_F(MarkersTest, WithoutTheOptionTheMapHasThem) {
  options_.poses = truth_;  // so that it is in the same frame
  EXPECT_THAT(BuildMap(options_).markers, IsEmpty());
  EXPECT_GT(KeypointsOnMarkers(), 20);
}

TEST_F(MarkersTest, OneMarkerWithItsYawIsEnough) {
  Build("id,x,y,yaw\n7,0.90,0.25," + std::to_string(0.5 * std::numbers::pi) + "\n");
  EXPECT_LT(WorstPoseErrorM(), 5e-3);
  EXPECT_THAT(Error("id,x,y,yaw\n7,0.90,0.25,\n"), HasSubstr("only one of its markers"));
}

TEST_F(MarkersTest, NamesAMarkerThatWasMovedAndDoesWithoutIt) {
  const BuildReport report = Build("id,x,y,yaw\n3,0.30,0.25,\n7,0.90,0.25,\n11,0.95,0.65,\n20,0.30,0.65,\n");
  EXPECT_THAT(report.warnings, Contains(::testing::AllOf(HasSubstr("marker 11 ("), HasSubstr("markers.csv:4"),
                                                         HasSubstr("is off by"), HasSubstr("not used"))));
  EXPECT_LT(WorstPoseErrorM(), 1e-3);
  for (const MarkerFit& fit : report.markers) {
    EXPECT_EQ(fit.used, fit.id != 11 && fit.id != 31) << fit.id;
  }
}

TEST_F(MarkersTest, NamesAMarkerThatIsTurned) {
  const BuildReport report = Build("id,x,y,yaw\n3,0.30,0.25,0\n7,0.90,0.25,0\n11,0.90,0.65,0\n20,0.30,0.65,\n");
  EXPECT_THAT(report.warnings, Contains(HasSubstr("marker 7 has another yaw than")));
  EXPECT_LT(WorstPoseErrorM(), 1e-3);
}

TEST_F(MarkersTest, SaysThatAllYawsAreOffByTheSameQuarterTurn) {
  const auto csv = [](double turn_rad) {
    const double quarter = 0.5 * std::numbers::pi;
    return "id,x,y,yaw\n3,0.30,0.25," + std::to_string(turn_rad) + "\n7,0.90,0.25," +
           std::to_string(quarter + turn_rad) + "\n20,0.30,0.65," + std::to_string(2.0 * quarter + turn_rad) + "\n";
  };
  EXPECT_LT(Build(csv(0.0)).markers[0].error_m, 1e-3);
  EXPECT_THAT(Error(csv(std::numbers::pi)), ::testing::AllOf(HasSubstr("markers.csv: the yaws of all 3 markers"),
                                                             HasSubstr("add 180 degrees to each")));
  EXPECT_THAT(Error(csv(0.5 * std::numbers::pi)), HasSubstr("add -90 degrees to each"));
}

// At 0.5 m/s, read out in 33 ms, with the marker at the edge of the view.
TEST(MarkerDetectionTest, CornersAreWhereTheyAreWhenTheMiddleRowIsExposed) {
  const TemporaryFolder folder;
  const FloorTexture floor = MarkedFloor();
  LoadedSurvey loaded;
  loaded.survey.folder = folder.path();
  loaded.survey.camera = MakeDownwardCamera();
  BuildFrame frame;
  frame.info.filename = "0.png";
  RenderConditions conditions;
  conditions.readout_motion = {0.0165, 0.002, 0.01};
  const Eigen::Vector2d center = loaded.survey.camera.floor.roi.Center() + Eigen::Vector2d(0.06, 0.0);
  const Pose2 pose = Pose2(0.6, 0.45, 0.1) * Pose2(-center.x(), -center.y(), 0.0);
  cv::imwrite((folder.path() / "0.png").string(), CameraRenderer(floor, loaded.survey.camera).Render(pose, conditions));
  MarkerDetectionOptions options;
  options.size_m = kMarkerM;
  const auto error_m = [&](const Eigen::Vector3d& readout_motion) {
    frame.readout_motion = readout_motion;
    for (const MarkerDetection& found : DetectMarkers({frame}, {loaded}, options)) {
      if (found.id == 31) {
        EXPECT_LT((FloorPointOf(frame, {loaded}, RawPixelOf(frame, {loaded}, found.Center())) - found.Center()).norm(),
                  1e-5);
        return (pose * found.Center() - Eigen::Vector2d(0.6, 0.45)).norm();
      }
    }
    return 1.0;
  };
  EXPECT_LT(error_m(conditions.readout_motion), 5e-4);
  EXPECT_GT(error_m(Eigen::Vector3d::Zero()), 2e-3);
}

TEST(CommonQuarterTurn, IsThatOfAll) {
  const double quarter = 0.5 * std::numbers::pi;
  EXPECT_EQ(CommonQuarterTurn({quarter, quarter + 0.05, quarter - 0.05}, 0.1), 1);
  EXPECT_EQ(CommonQuarterTurn({-quarter, 3.0 * quarter}, 0.1), -1);
  EXPECT_EQ(CommonQuarterTurn({2.0 * quarter, -2.0 * quarter + 0.05}, 0.1), 2);
  EXPECT_EQ(CommonQuarterTurn({0.0, 0.0}, 0.1), 0);
  EXPECT_EQ(CommonQuarterTurn({quarter, 0.0, quarter}, 0.1), 0);
  EXPECT_EQ(CommonQuarterTurn({0.5, 0.5}, 0.1), 0);
  EXPECT_EQ(CommonQuarterTurn({quarter}, 0.1), 0) << "of one, the position may be wrong as well";
  EXPECT_EQ(CommonQuarterTurn({}, 0.1), 0);
}

TEST_F(MarkersTest, NamesAMarkerOfTheFileThatIsNotSeen) {
  EXPECT_THAT(Build(std::string(kTrueCsv) + "40,5,5,\n").warnings, Contains(HasSubstr("marker 40 (")));
}

TEST_F(MarkersTest, RefusesAWrongSizeFileOrDictionary) {
  EXPECT_THAT(Error("id,x,y,yaw\n1,0,0,\n"), HasSubstr("none of its markers is in the images"));
  EXPECT_THAT(Error("id,x\n"), HasSubstr("first line must be 'id,x,y,yaw'"));
  options_.markers.detection.size_m = 0.05;
  EXPECT_THAT(Error(kTrueCsv), HasSubstr("measure 39."));
  options_.markers.detection.size_m = 0.0408;
  EXPECT_THAT(Build(kTrueCsv).warnings, Contains(HasSubstr("measure 39.")));
  options_.markers.detection.dictionary = "DICT_APRILTAG_36h11";
  EXPECT_THAT(Error(kTrueCsv), HasSubstr("no marker of DICT_APRILTAG_36h11"));
}

std::vector<MarkerPosition> PositionsUnder(const Pose2& motion, int count) {
  std::vector<MarkerPosition> positions;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d found(std::cos(2.0 * i) * (1.0 + 0.2 * i), std::sin(2.0 * i) * (1.0 + 0.3 * i));
    positions.push_back({found, motion * found});
  }
  return positions;
}

TEST(FindContradicting, FindsTheWrongOnesWhateverTheFrame) {
  for (const int count : {3, 4, 5, 40}) {
    std::vector<MarkerPosition> positions = PositionsUnder(Pose2(5, -3, 2.0), count);
    EXPECT_THAT(FindContradicting(positions), IsEmpty());
    EXPECT_THAT(RobustResiduals(positions), Each(::testing::Lt(1e-9)));
    positions[1].expected_m.x() += 0.05;
    EXPECT_EQ(FindContradicting(positions), std::vector<std::size_t>{1}) << count;
    EXPECT_NEAR(RobustResiduals(positions)[1], 0.05, 1e-9);
  }
}

TEST(FindContradicting, LeavesTwoAlone) {
  std::vector<MarkerPosition> positions = PositionsUnder(Pose2(), 2);
  positions[0].expected_m.x() += 0.5;
  EXPECT_THAT(FindContradicting(positions), IsEmpty());
}

}  // namespace
}  // namespace floorloc
