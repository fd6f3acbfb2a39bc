// SPDX-License-Identifier: Apache-2.0
#include "core/io/survey.h"

#include <fstream>

#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing_io::ErrorOf;
using testing_io::TemporaryFolder;

TEST(FolderName, IsTheLastComponentHoweverThePathIsWritten) {
  const std::filesystem::path here = std::filesystem::current_path().filename();
  EXPECT_EQ(FolderName("/data/hall"), "hall");
  EXPECT_EQ(FolderName("/data/hall/"), "hall");
  EXPECT_EQ(FolderName("/data/hall//"), "hall");
  EXPECT_EQ(FolderName("/data/old/../hall/."), "hall");
  EXPECT_EQ(FolderName("hall/"), "hall");
  EXPECT_EQ(FolderName("."), here);
  EXPECT_EQ(FolderName("./"), here);
}

TEST(FramesCsv, ReadsRows) {
  const auto frames = ParseFramesCsv("timestamp,filename\r\n1000.25, images/a.jpg \r\n\r\n# note\n1001,b c.png\n", "f");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].stamp_ns, 1000'250'000'000);
  EXPECT_EQ(frames[0].filename, "images/a.jpg");
  EXPECT_EQ(frames[1].filename, "b c.png");
}

TEST(FramesCsv, ReadsQuotesAndBackslashes) {
  const auto frames = ParseFramesCsv(
      "\"timestamp\",\"filename\"\r\n"
      "\"1000.25\",\"images\\a.jpg\"\r\n"
      "1001,.\\images\\b c.jpg\r\n"
      "1002 , \"images/d,e.jpg\" \r\n"
      "1003,\"images/the \"\"f\"\".jpg\"\r\n",
      "frames.csv");
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[0].stamp_ns, 1000'250'000'000);
  EXPECT_EQ(frames[0].filename, "images/a.jpg");
  EXPECT_EQ(frames[1].filename, "images/b c.jpg");
  EXPECT_EQ(frames[2].filename, "images/d,e.jpg");
  EXPECT_EQ(frames[3].filename, "images/the \"f\".jpg");
}

TEST(ImuCsv, ReadsWhatItWrites) {
  const std::vector<ImuSample> written = {{10, {1, -2, 0.25}, {4, 5, 9.8066501}}, {20, {0, 0, 0}, {0, 0, 0}}};
  const auto samples = ParseImuCsv(FormatImuCsv(written), "imu.csv");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].stamp_ns, 20);
  EXPECT_EQ(samples[0].angular_velocity, Eigen::Vector3d(1, -2, 0.25));
  EXPECT_LT((samples[0].acceleration - Eigen::Vector3d(4, 5, 9.8066501)).norm(), 1e-9);
}

TEST(ImuCsv, ReadsEurocRows) {
  const auto samples = ParseImuCsv("#timestamp [ns],w_x\n10,1,2,3,4,5,6\n20,-1,0,0,0,0,9.81\n", "imu.csv");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].stamp_ns, 10);
  EXPECT_EQ(samples[0].angular_velocity, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(samples[0].acceleration, Eigen::Vector3d(4, 5, 6));
}

TEST(ControlPointsCsv, ReadsRows) {
  const auto distances = ParseKnownDistancesCsv("filename1,u1,v1,filename2,u2,v2,distance\na.jpg,1,2,b.jpg,3,4,5.5\n",
                                                "known_distances.csv");
  ASSERT_EQ(distances.size(), 1U);
  EXPECT_EQ(distances[0].second_filename, "b.jpg");
  EXPECT_EQ(distances[0].first_raw_px, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(distances[0].second_raw_px, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(distances[0].distance_m, 5.5);
  const auto points = ParseControlPointsCsv("filename,u,v,x,y\na.jpg,1,2,3,4\na.jpg,5,6,7,8\n", "control_points.csv");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].filename, "a.jpg");
  EXPECT_EQ(points[1].raw_px, Eigen::Vector2d(5, 6));
  EXPECT_EQ(points[1].point_in_map_m, Eigen::Vector2d(7, 8));
}

TEST(ControlPointsCsv, ReadsWhatThePointsAreWorth) {
  const auto points = ParseControlPointsCsv("filename,u,v,x,y,sigma\na.jpg,1,2,3,4,0.02\nb.jpg,5,6,7,8,\n", "c.csv");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].sigma_m, 0.02);
  EXPECT_EQ(points[1].sigma_m, std::nullopt);
}

TEST(GcpList, ReadsRowsOfOpenDroneMap) {
  const auto points = ParseGcpList(
      "WGS84 UTM 32N\n# a comment\n691000.25 5336000.5 512.3 1024.5 768 DSC_1.JPG gcp1 extra\n"
      "691001\t5336002\tNaN\t1\t2\tDSC_2.JPG\n",
      "gcp_list.txt");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].filename, "DSC_1.JPG");
  EXPECT_EQ(points[0].raw_px, Eigen::Vector2d(1024.5, 768.0));
  EXPECT_EQ(points[0].point_in_map_m, Eigen::Vector2d(691000.25, 5336000.5));
  EXPECT_EQ(points[1].raw_px, Eigen::Vector2d(1.0, 2.0));
  EXPECT_TRUE(ParseGcpList("EPSG:32632\n", "gcp_list.txt").empty());
}

struct BrokenCsv {
  const char* name;
  const char* text;
  const char* where;
  const char* reason;
};
std::ostream& operator<<(std::ostream& out, const BrokenCsv& broken) { return out << broken.name; }

class BrokenFramesCsv : public ::testing::TestWithParam<BrokenCsv> {};

TEST_P(BrokenFramesCsv, NamesFileLineAndReason) {
  EXPECT_THAT(ErrorOf([] { ParseFramesCsv(GetParam().text, "frames.csv"); }),
              AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenCsv kBrokenFrames[] = {
    {"Empty", "", "frames.csv: ", "has no frames"},
    {"OnlyHeader", "timestamp,filename\n\n", "frames.csv: ", "has no frames"},
    {"NoHeader", "1000,a.jpg\n", "frames.csv:1: ", "first line must be 'timestamp,filename'"},
    {"OneField", "timestamp,filename\n1000\n", "frames.csv:2: ", "has 1 fields instead of 2"},
    {"ThreeFields", "timestamp,filename\n1000,a.jpg,b\n", "frames.csv:2: ", "has 3 fields instead of 2"},
    {"TextStamp", "timestamp,filename\n\nnoon,a.jpg\n", "frames.csv:3: ", "'noon' is not a number of seconds"},
    {"EmptyName", "timestamp,filename\n1000,\n", "frames.csv:2: ", "is not inside the folder"},
    {"AbsoluteName", "timestamp,filename\n1000,/etc/passwd\n", "frames.csv:2: ", "is not inside the folder"},
    {"LeadsOut", "timestamp,filename\n1000,images/../../a.jpg\n", "frames.csv:2: ", "is not inside the folder"},
    {"AbsoluteOnWindows", "timestamp,filename\n1000,C:\\survey\\a.jpg\n", "frames.csv:2: ", "is not inside the folder"},
    {"LeadsOutWithBackslashes", "timestamp,filename\n1000,..\\a.jpg\n", "frames.csv:2: ", "is not inside the folder"},
    {"SameNameInOtherSigns", "timestamp,filename\n1,i/a.jpg\n2,\".\\i\\a.jpg\"\n", "frames.csv:3: ", "listed twice"},
    {"OpenQuote", "timestamp,filename\n1000,\"a.jpg\n", "frames.csv:2: ", "must end with a quote"},
    {"TextAfterQuote", "timestamp,filename\n1000,\"a\".jpg\n", "frames.csv:2: ", "must end with a quote"},
    {"Semicolons", "timestamp;filename\n1000,5;a.jpg\n", "frames.csv:1: ", "are separated by semicolons"},
    {"Tabs", "timestamp\tfilename\n1000\ta.jpg\n", "frames.csv:1: ", "are separated by tabs"},
    {"SameName", "timestamp,filename\n1,a.jpg\n2,b.jpg\n3,a.jpg\n", "frames.csv:4: ", "a.jpg is listed twice"},
    {"SameStamp", "timestamp,filename\n1,a.jpg\n1.0,b.jpg\n", "frames.csv:3: ", "is not later than the one before"},
    {"Backwards", "timestamp,filename\n2,a.jpg\n1,b.jpg\n", "frames.csv:3: ", "is not later than the one before"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenFramesCsv, ::testing::ValuesIn(kBrokenFrames),
                         [](const auto& test) { return std::string(test.param.name); });

class BrokenImuCsv : public ::testing::TestWithParam<BrokenCsv> {};

TEST_P(BrokenImuCsv, NamesFileLineAndReason) {
  EXPECT_THAT(ErrorOf([] { ParseImuCsv(GetParam().text, "imu.csv"); }),
              AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenCsv kBrokenImu[] = {
    {"SixFields", "#t\n10,1,2,3,4,5\n", "imu.csv:2: ", "has 6 fields instead of 7"},
    {"Seconds", "10.5,1,2,3,4,5,6\n", "imu.csv:1: ", "not a whole number of nanoseconds"},
    {"Word", "10,1,2,three,4,5,6\n", "imu.csv:1: ", "'three' is not a finite number"},
    {"Nan", "10,1,2,3,4,5,nan\n", "imu.csv:1: ", "'nan' is not a finite number"},
    {"Backwards", "10,1,2,3,4,5,6\n9,1,2,3,4,5,6\n", "imu.csv:2: ", "is not later"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenImuCsv, ::testing::ValuesIn(kBrokenImu),
                         [](const auto& test) { return std::string(test.param.name); });

class BrokenControlPointsCsv : public ::testing::TestWithParam<BrokenCsv> {};

TEST_P(BrokenControlPointsCsv, NamesFileLineAndReason) {
  EXPECT_THAT(ErrorOf([] { ParseControlPointsCsv(GetParam().text, "control_points.csv"); }),
              AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenCsv kBrokenControlPoints[] = {
    {"NoHeader", "a.jpg,1,2,3,4\n", "control_points.csv:1: ", "first line must be 'filename,u,v,x,y'"},
    {"FourFields", "filename,u,v,x,y\na.jpg,1,2,3\n", "control_points.csv:2: ", "has 4 fields instead of 5"},
    {"Word", "filename,u,v,x,y\na.jpg,1,2,3,far\n", "control_points.csv:2: ", "'far' is not a finite number"},
    {"EmptyField", "filename,u,v,x,y\na.jpg,,2,3,4\n", "control_points.csv:2: ", "'' is not a finite number"},
    {"LeadsOut", "filename,u,v,x,y\n../a.jpg,1,2,3,4\n", "control_points.csv:2: ", "is not inside the folder"},
    {"SixthColumn", "filename,u,v,x,y,z\na.jpg,1,2,3,4,0\n", "control_points.csv:1: ", "filename,u,v,x,y,sigma"},
    {"NoSigma", "filename,u,v,x,y,sigma\na.jpg,1,2,3,4\n", "control_points.csv:2: ", "has 5 fields instead of 6"},
    {"ZeroSigma", "filename,u,v,x,y,sigma\na.jpg,1,2,3,4,0\n", "control_points.csv:2: ", "sigma is not positive"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenControlPointsCsv, ::testing::ValuesIn(kBrokenControlPoints),
                         [](const auto& test) { return std::string(test.param.name); });

class BrokenGcpList : public ::testing::TestWithParam<BrokenCsv> {};

TEST_P(BrokenGcpList, NamesFileLineAndReason) {
  EXPECT_THAT(ErrorOf([] { ParseGcpList(GetParam().text, "gcp_list.txt"); }),
              AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenCsv kBrokenGcps[] = {
    {"NoProjection", "1 2 3 4 5 a.jpg\n", "gcp_list.txt:1: ", "must name the projection"},
    {"Degrees", "EPSG:4326\n11.5 48.1 3 4 5 a.jpg\n", "gcp_list.txt:1: ", "longitude and latitude"},
    {"DegreesOfProj", "+proj=longlat +datum=WGS84\n", "gcp_list.txt:1: ", "longitude and latitude"},
    {"FiveFields", "WGS84 UTM 32N\n1 2 3 4 5\n", "gcp_list.txt:2: ", "has 5 fields"},
    {"Word", "WGS84 UTM 32N\n1 2 3 left 5 a.jpg\n", "gcp_list.txt:2: ", "'left' is not a number"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenGcpList, ::testing::ValuesIn(kBrokenGcps),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(MarkersCsv, ReadsRows) {
  const auto markers = ParseMarkersCsv("id,x,y,yaw\n3,1.5,-2,\n# gate\n17,0,4,1.57\n", "markers.csv");
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_EQ(markers[0].id, 3);
  EXPECT_EQ(markers[0].center_in_map_m, Eigen::Vector2d(1.5, -2));
  EXPECT_FALSE(markers[0].yaw_rad.has_value());
  EXPECT_EQ(markers[1].yaw_rad, 1.57);
  EXPECT_EQ(markers[1].line, 4);
}

class BrokenMarkersCsv : public ::testing::TestWithParam<BrokenCsv> {};

TEST_P(BrokenMarkersCsv, NamesFileLineAndReason) {
  EXPECT_THAT(ErrorOf([] { ParseMarkersCsv(GetParam().text, "markers.csv"); }),
              AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenCsv kBrokenMarkers[] = {
    {"NoHeader", "3,1,2,\n", "markers.csv:1: ", "first line must be 'id,x,y,yaw'"},
    {"Empty", "id,x,y,yaw\n", "markers.csv: ", "has no markers"},
    {"ThreeFields", "id,x,y,yaw\n3,1,2\n", "markers.csv:2: ", "has 3 fields instead of 4"},
    {"Word", "id,x,y,yaw\n3,1,2,north\n", "markers.csv:2: ", "'north' is not a finite number"},
    {"Degrees", "id,x,y,yaw\n3,1,2,90\n", "markers.csv:2: ", "'90' is more than a full turn; write it in radians"},
    {"NoPlace", "id,x,y,yaw\n3,,2,\n", "markers.csv:2: ", "'' is not a finite number"},
    {"HalfId", "id,x,y,yaw\n3.5,1,2,\n", "markers.csv:2: ", "must be a whole number"},
    {"NegativeId", "id,x,y,yaw\n-1,1,2,\n", "markers.csv:2: ", "must be a whole number"},
    {"Twice", "id,x,y,yaw\n3,1,2,\n3,4,5,\n", "markers.csv:3: ", "marker 3 is listed twice"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenMarkersCsv, ::testing::ValuesIn(kBrokenMarkers),
                         [](const auto& test) { return std::string(test.param.name); });

class SurveyFolder : public ::testing::Test {
 protected:
  SurveyFolder() {
    std::filesystem::create_directory(folder_.path() / "images");
    Write("camera.yaml", testing_io::kCameraYaml);
    Write("floor.yaml", testing_io::kFloorYaml);
    Write("frames.csv", "timestamp,filename\n10,images/b.jpg\n11,images/a.png\n");
    Write("images/a.png", "only looked for");
    Write("images/b.jpg", "only looked for");
  }
  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }
  void Remove(const std::string& name) { std::filesystem::remove_all(folder_.path() / name); }
  Survey Read() const { return ReadSurvey(folder_.path()); }
  std::string Error() const {
    return ErrorOf([this] { Read(); });
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(SurveyFolder, ReadsTheSmallestOne) {
  const Survey survey = Read();
  ASSERT_EQ(survey.frames.size(), 2u);
  EXPECT_EQ(survey.frames[0].filename, "images/b.jpg");
  EXPECT_TRUE(std::filesystem::exists(survey.ImagePath(survey.frames[0])));
  EXPECT_EQ(survey.camera.camera.width_px, 640);
  EXPECT_TRUE(survey.odometry.empty() && survey.ground_truth.empty());
  EXPECT_TRUE(survey.imu.empty() && survey.control_points.empty());
}

TEST_F(SurveyFolder, StampsAreThoseOfTheMiddleRow) {
  const auto first_ns = [this](const std::string& keys) {
    Write("camera.yaml", testing_io::kCameraYaml + keys);
    return Read().frames[0].stamp_ns;
  };
  EXPECT_EQ(first_ns("readout_s: 0.03\n"), 10'000'000'000);
  EXPECT_EQ(first_ns("readout_s: 0.03\nstamp_at: start\n"), 10'015'000'000);
  EXPECT_EQ(first_ns("readout_s: 0.03\nstamp_at: end\n"), 9'985'000'000);
}

TEST_F(SurveyFolder, ReadsEveryPart) {
  Write("odometry.tum", "10 1 0 0 0 0 0 1\n");
  Write("groundtruth.tum", "10 2 0 0 0 0 0 1\n");
  Write("imu.csv", "10,1,2,3,4,5,6\n");
  Write("control_points.csv", "filename,u,v,x,y\nimages/a.png,1,2,3,4\n");
  const Survey survey = Read();
  ASSERT_EQ(survey.odometry.size(), 1u);
  EXPECT_EQ(survey.odometry[0].translation_m.x(), 1);
  ASSERT_EQ(survey.ground_truth.size(), 1u);
  EXPECT_EQ(survey.ground_truth[0].translation_m.x(), 2);
  EXPECT_EQ(survey.imu.size(), 1u);
  EXPECT_EQ(survey.control_points.size(), 1u);
}

TEST_F(SurveyFolder, ListsImagesWithoutFramesCsv) {
  Remove("frames.csv");
  Write("images/notes.txt", "no image");
  Write("images/C.JPEG", "an image");
  const Survey survey = Read();
  ASSERT_EQ(survey.frames.size(), 3u);
  EXPECT_EQ(survey.frames[0].filename, "images/C.JPEG");
  EXPECT_EQ(survey.frames[1].filename, "images/a.png");
  EXPECT_EQ(survey.frames[2].filename, "images/b.jpg");
  EXPECT_EQ(survey.frames[0].stamp_ns, 0);
  EXPECT_EQ(survey.frames[2].stamp_ns, 2'000'000'000);
}

TEST_F(SurveyFolder, SaysWhatIsMissing) {
  EXPECT_THAT(ErrorOf([] { ReadSurvey("/nonexistent/survey"); }), HasSubstr("/nonexistent/survey: is not a folder"));
  Remove("images/a.png");
  EXPECT_THAT(Error(), AllOf(HasSubstr("frames.csv:3: "), HasSubstr("images/a.png is missing")));
  Write("frames.csv", "timestamp,filename\n");
  EXPECT_THAT(Error(), HasSubstr("frames.csv: has no frames"));
  Remove("frames.csv");
  Remove("images/b.jpg");
  EXPECT_THAT(Error(), HasSubstr("images: has no frames"));
  Remove("images");
  EXPECT_THAT(Error(), HasSubstr("has neither frames.csv nor a readable folder images"));
  Remove("camera.yaml");
  EXPECT_THAT(Error(), HasSubstr("camera.yaml: cannot be opened"));
}

TEST_F(SurveyFolder, AFolderIsNoImage) {
  const std::filesystem::path image = Read().folder / "images" / "a.png";
  std::filesystem::remove(image);
  std::filesystem::create_directory(image);
  EXPECT_THAT(Error(), HasSubstr("images/a.png is missing"));
}

TEST_F(SurveyFolder, RefusesControlPointsOfUnknownImages) {
  Write("control_points.csv", "filename,u,v,x,y\n# corner\nimages/a.png,1,2,3,4\nimages/z.png,1,2,3,4\n");
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("control_points.csv:4: "), HasSubstr("images/z.png is not a frame of the survey")));
}

TEST_F(SurveyFolder, GcpListsNameImagesWithoutTheirFolder) {
  Write("gcp_list.txt", "WGS84 UTM 32N\n5 6 0 1 2 a.png\n7 8 0 3 4 images/b.jpg\n");
  const Survey survey = Read();
  ASSERT_EQ(survey.control_points.size(), 2U);
  EXPECT_EQ(survey.control_points[0].filename, "images/a.png");
  EXPECT_EQ(survey.control_points[1].filename, "images/b.jpg");
  EXPECT_EQ(survey.control_point_file.filename(), "gcp_list.txt");
  Write("control_points.csv", "filename,u,v,x,y\nimages/a.png,1,2,5,6\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("gcp_list.txt: "), HasSubstr("keep one of the two")));
  Remove("control_points.csv");
  Write("gcp_list.txt", "WGS84 UTM 32N\n5 6 0 1 2 z.png\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("gcp_list.txt:2: "), HasSubstr("z.png is not a frame")));
}

TEST_F(SurveyFolder, TablesOfWindowsNameTheSameImages) {
  Write("frames.csv", "timestamp,filename\r\n10,images\\b.jpg\r\n11,\"images\\a.png\"\r\n");
  Write("control_points.csv", "filename,u,v,x,y\nimages\\a.png,1,2,3,4\n\"images/b.jpg\",1,2,3,4\n");
  Write("known_distances.csv", "filename1,u1,v1,filename2,u2,v2,distance\n.\\images\\a.png,1,2,images/b.jpg,3,4,5\n");
  const Survey survey = Read();
  EXPECT_EQ(survey.frames[1].filename, "images/a.png");
  EXPECT_EQ(survey.control_points[0].filename, "images/a.png");
  EXPECT_EQ(survey.known_distances[0].first_filename, "images/a.png");
  Remove("images/a.png");
  EXPECT_THAT(Error(), AllOf(HasSubstr("frames.csv:3: "), HasSubstr("images/a.png is missing")));
}

TEST_F(SurveyFolder, RefusesOdometryThatIsNotOfARobotOnAFloor) {
  Write("odometry.tum", "10 1 0 0 1 0 0 0\n11 2 0 0 0.9 0 0 0.435889894\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("odometry.tum: "), HasSubstr("qw first")));
  Remove("odometry.tum");
  Write("groundtruth.tum", "10 1 0 0 0 0 0 1\n11 2 0 9 0 0 0 1\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("groundtruth.tum: "), HasSubstr("tz changes by 9.00 m")));
}

TEST_F(SurveyFolder, PassesOnErrorsOfItsParts) {
  Write("imu.csv", "10,1\n");
  EXPECT_THAT(Error(), HasSubstr("imu.csv:1: "));
  Write("groundtruth.tum", "x\n");
  EXPECT_THAT(Error(), HasSubstr("groundtruth.tum:1: "));
  Write("odometry.tum", "x\n");
  EXPECT_THAT(Error(), HasSubstr("odometry.tum:1: "));
}

}  // namespace
}  // namespace floorloc
