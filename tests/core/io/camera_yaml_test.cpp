// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_yaml.h"

#include <fstream>

#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing_io::ErrorOf;
using testing_io::kCameraYaml;
using testing_io::kFloorYaml;
using testing_io::Replaced;
using testing_io::TemporaryFolder;

void ExpectSame(const CameraModel& a, const CameraModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  EXPECT_EQ(a.fx, b.fx);
  EXPECT_EQ(a.fy, b.fy);
  EXPECT_EQ(a.cx, b.cx);
  EXPECT_EQ(a.cy, b.cy);
  EXPECT_EQ(a.distortion_model, b.distortion_model);
  EXPECT_EQ(a.distortion, b.distortion);
  EXPECT_EQ(a.sigma_px, b.sigma_px);
}

TEST(CameraYaml, ReadsRosCameraInfo) {
  const CameraModel camera = ParseCameraYaml(kCameraYaml, "camera.yaml");
  CameraModel expected;
  expected.name = "front";
  expected.width_px = 640;
  expected.height_px = 480;
  expected.fx = 598.3;
  expected.fy = 597.6;
  expected.cx = 322.4;
  expected.cy = 238.7;
  expected.distortion = {-0.25, 0.06, 0.0008, -0.0005, 0.0};
  ExpectSame(camera, expected);
}

TEST(CameraYaml, ReadsTheSameAsJson) {
  const std::string json =
      R"({"image_width": 640, "image_height": 480, "camera_name": "front", "distortion_model": "plumb_bob",)"
      R"( "camera_matrix": {"rows": 3, "cols": 3, "data": [598.3, 0, 322.4, 0, 597.6, 238.7, 0, 0, 1]},)"
      R"( "distortion_coefficients": [-0.25, 6e-2, 8e-4, -5e-4, 0]})";
  ExpectSame(ParseCameraYaml(json, "request"), ParseCameraYaml(kCameraYaml, "camera.yaml"));
}

TEST(CameraYaml, WritesWhatItReads) {
  CameraModel camera = ParseCameraYaml(kCameraYaml, "camera.yaml");
  camera.name = "a: \"strange\" name\n# yes";
  camera.distortion_model = DistortionModel::kEquidistant;
  camera.distortion = {1.0 / 3.0, 1e-17, -4e-4, 0.0};
  camera.sigma_px = 1.0 / 7.0;
  ExpectSame(ParseCameraYaml(FormatCameraYaml(camera), "camera.yaml"), camera);
}

TEST(CameraYaml, WhatACalibrationIsWorthMayBeUnknown) {
  EXPECT_EQ(ParseCameraYaml(kCameraYaml, "camera.yaml").sigma_px, 0.0);
  EXPECT_EQ(ParseCameraYaml(std::string(kCameraYaml) + "calibration_sigma: 0.25\n", "camera.yaml").sigma_px, 0.25);
  EXPECT_EQ(ParseCameraYaml(std::string(kCameraYaml) + "calibration_sigma:\n", "camera.yaml").sigma_px, 0.0);
  EXPECT_THAT(FormatCameraYaml(ParseCameraYaml(kCameraYaml, "camera.yaml")), Not(HasSubstr("calibration_sigma")));
}

TEST(CameraYaml, TheReadoutMayBeUnknown) {
  const Readout unknown = ParseCameraYaml(kCameraYaml, "camera.yaml").readout;
  EXPECT_FALSE(unknown.seconds);
  EXPECT_EQ(unknown.direction, ReadoutDirection::kDown);
  EXPECT_EQ(unknown.stamp_at, StampAt::kMiddle);
  const std::string keys = "readout_s: 0.021\nreadout_direction: up\nstamp_at: start\n";
  const CameraModel camera = ParseCameraYaml(kCameraYaml + keys, "camera.yaml");
  EXPECT_EQ(camera.readout.seconds, 0.021);
  EXPECT_EQ(camera.readout.direction, ReadoutDirection::kUp);
  EXPECT_EQ(camera.readout.stamp_at, StampAt::kStart);
  EXPECT_EQ(ParseCameraYaml(std::string(kCameraYaml) + "readout_s: 0\n", "camera.yaml").readout.seconds, 0.0);
}

TEST(CameraYaml, WritesTheReadoutThatItReads) {
  CameraModel camera = ParseCameraYaml(kCameraYaml, "camera.yaml");
  EXPECT_THAT(FormatCameraYaml(camera), AllOf(Not(HasSubstr("readout")), Not(HasSubstr("stamp_at"))));
  camera.readout = {1.0 / 30.0, ReadoutDirection::kLeft, StampAt::kEnd};
  const Readout again = ParseCameraYaml(FormatCameraYaml(camera), "camera.yaml").readout;
  EXPECT_EQ(again.seconds, camera.readout.seconds);
  EXPECT_EQ(again.direction, camera.readout.direction);
  EXPECT_EQ(again.stamp_at, camera.readout.stamp_at);
}

TEST(FloorYaml, ReadsListsAndMatrices) {
  const FloorPlane floor = ParseFloorYaml(kFloorYaml, "floor.yaml");
  EXPECT_EQ(floor.base_from_pixel(0, 1), -0.00067);
  EXPECT_EQ(floor.base_from_pixel(1, 2), 0.2155);
  EXPECT_EQ(floor.roi.x_min, 0.045);
  EXPECT_EQ(floor.roi.x_max, 0.355);
  EXPECT_EQ(floor.roi.y_min, -0.205);
  EXPECT_EQ(floor.roi.y_max, 0.21);
  EXPECT_EQ(floor.resolution_m, 0.0007);
  const std::string matrix = Replaced(kFloorYaml, "[0.0, -0.00067, 0.36, -0.00067, 0.0, 0.2155, 0.0, 0.0, 1.0]",
                                      "{rows: 3, cols: 3, data: [0, -0.00067, 0.36, -0.00067, 0, 0.2155, 0, 0, 1]}");
  EXPECT_EQ(ParseFloorYaml(matrix, "floor.yaml").base_from_pixel, floor.base_from_pixel);
}

TEST(FloorYaml, WritesWhatItReads) {
  FloorPlane floor = ParseFloorYaml(kFloorYaml, "floor.yaml");
  floor.base_from_pixel(2, 0) = 1.0246375494874106e-19;
  floor.offset_sigma_m = 0.002;
  const std::string text = FormatFloorYaml(floor);
  const FloorPlane again = ParseFloorYaml(text, "floor.yaml");
  EXPECT_EQ(again.base_from_pixel, floor.base_from_pixel);
  EXPECT_EQ(again.roi.x_min, floor.roi.x_min);
  EXPECT_EQ(again.roi.y_max, floor.roi.y_max);
  EXPECT_EQ(again.resolution_m, floor.resolution_m);
  EXPECT_EQ(again.offset_sigma_m, floor.offset_sigma_m);
  EXPECT_THAT(text, HasSubstr("resolution: 7.0e-04")) << "YAML 1.1 takes a number without a dot for a string";
}

TEST(FloorYaml, TheBasesPlaceMayBeUnknown) {
  const FloorPlane floor = ParseFloorYaml(kFloorYaml, "floor.yaml");
  EXPECT_EQ(floor.offset_sigma_m, 0.0);
  EXPECT_THAT(FormatFloorYaml(floor), Not(HasSubstr("offset_sigma")));
}

struct BrokenYaml {
  const char* name;
  const char* from;
  const char* to;
  const char* where;
  const char* reason;
};
std::ostream& operator<<(std::ostream& out, const BrokenYaml& broken) { return out << broken.name; }

class BrokenCameraYaml : public ::testing::TestWithParam<BrokenYaml> {};

TEST_P(BrokenCameraYaml, NamesFileLineAndReason) {
  const BrokenYaml& broken = GetParam();
  const std::string text = Replaced(kCameraYaml, broken.from, broken.to);
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(text, "dir/camera.yaml"); }),
              AllOf(StartsWith(broken.where), HasSubstr(broken.reason)));
}

const BrokenYaml kBrokenCameras[] = {
    {"NoWidth", "image_width: 640\n", "", "dir/camera.yaml: ", "'image_width' is missing"},
    {"NullWidth", "640", "", "dir/camera.yaml: ", "'image_width' is missing"},
    {"TextWidth", "640", "wide", "dir/camera.yaml:1: ", "image_width must be a finite number"},
    {"ListWidth", "640", "[640]", "dir/camera.yaml:1: ", "image_width must be a finite number"},
    {"FractionalWidth", "640", "640.5", "dir/camera.yaml:1: ", "image_width must be a whole number"},
    {"HugeWidth", "640", "1e300", "dir/camera.yaml:1: ", "image_width must be a whole number"},
    {"LargeWidth", "640", "20000", "dir/camera.yaml: ", "image_width must be 1 to 16384 pixels"},
    {"NegativeHeight", "480", "-480", "dir/camera.yaml: ", "image_height must be 1 to 16384 pixels"},
    {"MapAsName", "front", "{a: b}", "dir/camera.yaml:3: ", "camera_name must be a string"},
    {"NoMatrix", "camera_matrix", "matrix", "dir/camera.yaml: ", "'camera_matrix' is missing"},
    {"NoData", "data", "dada", "dir/camera.yaml: ", "'data' is missing"},
    {"NoRows", "rows", "raws", "dir/camera.yaml: ", "'rows' is missing"},
    {"WrongShape", "rows: 3", "rows: 4", "dir/camera.yaml:5: ", "camera_matrix: rows x cols"},
    {"TextData", "[598.3, 0.0, 322.4, 0.0, 597.6, 238.7, 0.0, 0.0, 1.0]", "many",
     "dir/camera.yaml:7: ", "camera_matrix must be a list of numbers"},
    {"NanFocal", "598.3", ".nan", "dir/camera.yaml:7: ", "camera_matrix must be a finite number"},
    {"InfiniteFocal", "598.3", "1e999", "dir/camera.yaml:7: ", "camera_matrix must be a finite number"},
    {"NegativeFocal", "598.3", "-598.3", "dir/camera.yaml: ", "focal lengths"},
    {"Skew", "598.3, 0.0", "598.3, 2.0", "dir/camera.yaml:5: ", "[fx, 0, cx, 0, fy, cy, 0, 0, 1]"},
    {"UnknownModel", "plumb_bob", "brown", "dir/camera.yaml:8: ", "distortion_model must be plumb_bob"},
    {"ModelOfOtherCount", "plumb_bob", "equidistant", "dir/camera.yaml: ", "distortion_coefficients"},
    {"WordInDistortion", "0.06", "six", "dir/camera.yaml:12: ", "distortion_coefficients must be a finite number"},
    {"NegativeSigma", "camera_name: front", "calibration_sigma: -0.1",
     "dir/camera.yaml: ", "calibration_sigma must be a number of pixels, 0 or more"},
    {"LongReadout", "camera_name: front", "readout_s: 21",
     "dir/camera.yaml: ", "readout_s must be the seconds from the first row to the last one"},
    {"TextReadout", "camera_name: front", "readout_s: fast",
     "dir/camera.yaml:3: ", "readout_s must be a finite number"},
    {"ReadoutDirection", "camera_name: front", "readout_direction: north",
     "dir/camera.yaml:3: ", "readout_direction must be down, up, right or left"},
    {"StampAt", "camera_name: front", "stamp_at: begin",
     "dir/camera.yaml:3: ", "stamp_at must be start, middle or end"},
    {"StampWithoutReadout", "camera_name: front", "stamp_at: start",
     "dir/camera.yaml: ", "stamp_at start or end needs readout_s"},
    {"TextSigma", "camera_name: front", "calibration_sigma: good",
     "dir/camera.yaml:3: ", "calibration_sigma must be a finite number"},
    {"UnclosedList", "1.0]", "1.0", "dir/camera.yaml:", "is not valid YAML"},
    {"Tab", "  rows", "\trows", "dir/camera.yaml:", "is not valid YAML"},
    {"WidthTwice", "image_height", "image_width", "dir/camera.yaml:2: ", "the key 'image_width' is given twice"},
    {"DataTwice", "  cols: 3", "  data: [1]", "dir/camera.yaml:7: ", "the key 'data' is given twice"},
    {"UnknownAlias", "front", "*nobody", "dir/camera.yaml:3: ", "is not valid YAML"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenCameraYaml, ::testing::ValuesIn(kBrokenCameras),
                         [](const auto& test) { return std::string(test.param.name); });

class BrokenFloorYaml : public ::testing::TestWithParam<BrokenYaml> {};

TEST_P(BrokenFloorYaml, NamesFileLineAndReason) {
  const BrokenYaml& broken = GetParam();
  const std::string text = Replaced(kFloorYaml, broken.from, broken.to);
  EXPECT_THAT(ErrorOf([&] { ParseFloorYaml(text, "dir/floor.yaml"); }),
              AllOf(StartsWith(broken.where), HasSubstr(broken.reason)));
}

const BrokenYaml kBrokenFloors[] = {
    {"HomographyTwice", "resolution", "homography", "dir/floor.yaml:3: ", "the key 'homography' is given twice"},
    {"BoundTwice", "y_max", "x_max", "dir/floor.yaml:2: ", "the key 'x_max' is given twice"},
    {"NoHomography", "homography", "homographie", "dir/floor.yaml: ", "'homography' is missing"},
    {"EightNumbers", ", 1.0]", "]", "dir/floor.yaml:1: ", "homography must have 9 numbers but has 8"},
    {"ScalarHomography", "[0.0, -0.00067, 0.36, -0.00067, 0.0, 0.2155, 0.0, 0.0, 1.0]", "1",
     "dir/floor.yaml:1: ", "homography must be a list"},
    {"NestedHomography", "0.36", "[0.36]", "dir/floor.yaml:1: ", "homography must be a finite number"},
    {"SingularHomography", "-0.00067", "0", "dir/floor.yaml: ", "homography is singular"},
    {"NoRoi", "roi:", "region:", "dir/floor.yaml: ", "'roi' is missing"},
    {"ListRoi", "{x_min: 0.045, x_max: 0.355, y_min: -0.205, y_max: 0.21}", "[1, 2]",
     "dir/floor.yaml:2: ", "roi must have the keys"},
    {"NoYMax", "y_max", "ymax", "dir/floor.yaml: ", "'y_max' is missing"},
    {"TextXMin", "0.045", "left", "dir/floor.yaml:2: ", "roi.x_min must be a finite number"},
    {"SwappedRoi", "0.045", "0.45", "dir/floor.yaml: ", "x_min < x_max"},
    {"NoResolution", "resolution", "res", "dir/floor.yaml: ", "'resolution' is missing"},
    {"ResolutionWithUnit", "0.0007", "0.7 mm", "dir/floor.yaml:3: ", "resolution must be a finite number"},
    {"NegativeResolution", "0.0007", "-0.0007", "dir/floor.yaml: ", "resolution must be a positive number"},
    {"NegativeOffsetSigma", "resolution: 0.0007", "resolution: 0.0007\noffset_sigma: -0.001",
     "dir/floor.yaml: ", "offset_sigma must be a number of metres, 0 or more"},
    {"ListOffsetSigma", "resolution: 0.0007", "resolution: 0.0007\noffset_sigma: [0.001]",
     "dir/floor.yaml:4: ", "offset_sigma must be a finite number"},
    {"MillimetresPerPixel", "0.0007", "0.7", "dir/floor.yaml: ", "less than 16 pixels"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenFloorYaml, ::testing::ValuesIn(kBrokenFloors),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CameraYaml, RefusesWhatIsNoMap) {
  for (const std::string text : {"", "# nothing\n", "just words", "- a\n- b\n", "42", "~"}) {
    EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(text, "camera.yaml"); }), HasSubstr("camera.yaml: has no YAML keys"))
        << text;
  }
}

TEST(CameraYaml, SurvivesHostileDocuments) {
  const std::string deep_list = "image_width: " + std::string(200'000, '[');
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(deep_list, "camera.yaml"); }), HasSubstr("is not valid YAML"));
  const std::string deep_map = "image_width: " + std::string(200'000, '{');
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(deep_map, "camera.yaml"); }), HasSubstr("is not valid YAML"));
  std::string laughs = "a0: &a0 [1, 2]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string previous = std::to_string(i - 1);
    const std::string current = std::to_string(i);
    laughs += "a" + current + ": &a" + current + " [*a" + previous + ", *a" + previous + "]\n";
  }
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(laughs + "image_width: *a39\n", "camera.yaml"); }),
              HasSubstr("image_width must be a finite number"));
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml("image_width: &a [*a]\n", "camera.yaml"); }), HasSubstr("camera.yaml"));
  EXPECT_THAT(ErrorOf([&] { ParseCameraYaml(std::string((1 << 20) + 1, ' '), "camera.yaml"); }),
              HasSubstr("larger than 1 MiB"));
}

class FloorCameraFiles : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) { std::ofstream(folder_.path() / name) << text; }
  std::string Error() {
    return ErrorOf([&] { ReadFloorCamera(folder_.path()); });
  }
  TemporaryFolder folder_;
};

TEST_F(FloorCameraFiles, ReadsBoth) {
  Write("camera.yaml", kCameraYaml);
  Write("floor.yaml", kFloorYaml);
  const FloorCamera camera = ReadFloorCamera(folder_.path());
  EXPECT_EQ(camera.camera.width_px, 640);
  EXPECT_EQ(camera.floor.resolution_m, 0.0007);
}

TEST_F(FloorCameraFiles, NamesTheGuiltyFile) {
  EXPECT_THAT(Error(), HasSubstr("/camera.yaml: cannot be opened"));
  Write("camera.yaml", Replaced(kCameraYaml, "597.6", "0"));
  Write("floor.yaml", kFloorYaml);
  EXPECT_THAT(Error(), AllOf(HasSubstr("/camera.yaml: "), HasSubstr("focal lengths")));
  Write("camera.yaml", kCameraYaml);
  Write("floor.yaml", Replaced(kFloorYaml, "0.0, -0.00067", "0.0, 0.00067"));
  EXPECT_THAT(Error(), AllOf(HasSubstr("/floor.yaml: "), HasSubstr("mirrored")));
  std::filesystem::remove(folder_.path() / "floor.yaml");
  EXPECT_THAT(Error(), HasSubstr("/floor.yaml: cannot be opened"));
}

}  // namespace
}  // namespace floorloc
