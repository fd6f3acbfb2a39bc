// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_import.h"

#include <stdexcept>

#include "core/io/camera_yaml.h"
#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing_io::ErrorOf;
using testing_io::Replaced;

// As Kalibr writes it (github.com/ethz-asl/kalibr/wiki/yaml-formats).
constexpr char kCamchain[] =
    "cam0:\n"
    "  T_cam_imu:\n"
    "  - [0.0178, 0.9997, -0.0182, 0.0701]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n"
    "  cam_overlaps: []\n"
    "  camera_model: pinhole\n"
    "  distortion_coeffs: [-0.277, 0.0671, 0.000875, 0.000116]\n"
    "  distortion_model: radtan\n"
    "  intrinsics: [461.6, 460.2, 362.7, 246.0]\n"
    "  resolution: [752, 480]\n"
    "  rostopic: /cam0/image_raw\n";

// As cv::FileStorage writes it in the calibration sample of OpenCV.
constexpr char kFileStorage[] =
    "%YAML:1.0\n"
    "---\n"
    "image_width: 640\n"
    "image_height: 480\n"
    "fisheye_model: 0\n"
    "camera_matrix: !!opencv-matrix\n"
    "   rows: 3\n"
    "   cols: 3\n"
    "   dt: d\n"
    "   data: [ 5.98e+02, 0., 3.22e+02, 0., 5.97e+02, 2.38e+02, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n"
    "   rows: 5\n"
    "   cols: 1\n"
    "   dt: d\n"
    "   data: [ -0.25, 0.06, 0.0008, -0.0005, 0.01 ]\n";

// As 'ros2 topic echo --once' prints it; ROS 1 has K, D and P.
constexpr char kCameraInfo[] =
    "header:\n"
    "  stamp: {sec: 1, nanosec: 0}\n"
    "  frame_id: camera_optical\n"
    "height: 480\n"
    "width: 640\n"
    "distortion_model: plumb_bob\n"
    "d: [-0.25, 0.06, 0.0008, -0.0005, 0.01]\n"
    "k: [598.0, 0.0, 322.0, 0.0, 597.0, 238.0, 0.0, 0.0, 1.0]\n"
    "r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
    "p: [571.0, 0.0, 323.5, 0.0, 0.0, 572.0, 237.5, 0.0, 0.0, 0.0, 1.0, 0.0]\n"
    "binning_x: 0\n"
    "binning_y: 0\n"
    "roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}\n"
    "---\n";

// As Python scripts after OpenCV's tutorial dump it.
constexpr char kPythonDump[] =
    "camera_matrix:\n"
    "- [598.0, 0.0, 322.0]\n"
    "- [0.0, 597.0, 238.0]\n"
    "- [0.0, 0.0, 1.0]\n"
    "dist_coeff:\n"
    "- [-0.25, 0.06, 0.0008, -0.0005, 0.01]\n";

ImportedCamera Import(const std::string& text, const CameraImportOptions& options = {}) {
  return ImportCamera(text, "dir/calib.yaml", options);
}

void ExpectTheSampleCamera(const CameraModel& camera) {
  EXPECT_EQ(camera.width_px, 640);
  EXPECT_EQ(camera.height_px, 480);
  EXPECT_EQ(camera.fx, 598.0);
  EXPECT_EQ(camera.fy, 597.0);
  EXPECT_EQ(camera.cx, 322.0);
  EXPECT_EQ(camera.cy, 238.0);
  EXPECT_EQ(camera.distortion_model, DistortionModel::kPlumbBob);
  EXPECT_THAT(camera.distortion, ElementsAre(-0.25, 0.06, 0.0008, -0.0005, 0.01));
}

TEST(ImportCamera, ReadsACamchainOfKalibr) {
  const ImportedCamera imported = Import(kCamchain);
  EXPECT_EQ(imported.format, "a camchain of Kalibr");
  EXPECT_EQ(imported.camera.name, "cam0");
  EXPECT_EQ(imported.camera.width_px, 752);
  EXPECT_EQ(imported.camera.height_px, 480);
  EXPECT_EQ(imported.camera.fx, 461.6);
  EXPECT_EQ(imported.camera.fy, 460.2);
  EXPECT_EQ(imported.camera.cx, 362.7);
  EXPECT_EQ(imported.camera.cy, 246.0);
  EXPECT_EQ(imported.camera.distortion_model, DistortionModel::kPlumbBob);
  EXPECT_THAT(imported.camera.distortion, ElementsAre(-0.277, 0.0671, 0.000875, 0.000116));
}

TEST(ImportCamera, ReadsAFisheyeOfKalibr) {
  const CameraModel camera = Import(Replaced(kCamchain, "radtan", "equidistant")).camera;
  EXPECT_EQ(camera.distortion_model, DistortionModel::kEquidistant);
  EXPECT_EQ(camera.distortion.size(), 4u);
}

TEST(ImportCamera, TakesTheCameraOfAChainThatIsAskedFor) {
  const std::string two = kCamchain + Replaced(Replaced(kCamchain, "cam0:", "cam1:"), "461.6", "500.5");
  EXPECT_THAT(ErrorOf([&] { Import(two); }), HasSubstr("choose one of cam0, cam1 with --camera"));
  CameraImportOptions options;
  options.camera = "cam1";
  EXPECT_EQ(Import(two, options).camera.fx, 500.5);
  options.camera = "cam2";
  EXPECT_THAT(ErrorOf([&] { Import(two, options); }), HasSubstr("has no camera 'cam2'; --camera may be cam0, cam1"));
}

TEST(ImportCamera, ReadsEurocsSensorYaml) {
  const CameraModel camera =
      Import(
          "sensor_type: camera\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.6, 457.3, 367.2, "
          "248.4]\ndistortion_model: radial-tangential\ndistortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]\n")
          .camera;
  EXPECT_EQ(camera.fy, 457.3);
  EXPECT_EQ(camera.distortion.front(), -0.28);
}

TEST(ImportCamera, ReadsOpenCvsFileStorage) {
  const ImportedCamera imported = Import(kFileStorage);
  EXPECT_EQ(imported.format, "a file of OpenCV's FileStorage");
  ExpectTheSampleCamera(imported.camera);
  const std::string before_version_3 = Replaced(kFileStorage, "%YAML:1.0\n---\n", "%YAML:1.0\n");
  ExpectTheSampleCamera(Import(before_version_3).camera);
}

TEST(ImportCamera, FourCoefficientsOfOpenCvAreAFisheyesOnlyIfItSaysSo) {
  const std::string four = Replaced(Replaced(kFileStorage, "rows: 5", "rows: 4"), ", 0.01 ]", " ]");
  EXPECT_EQ(Import(four).camera.distortion_model, DistortionModel::kPlumbBob) << "fisheye_model: 0";
  EXPECT_EQ(Import(Replaced(four, "fisheye_model: 0", "fisheye_model: 1")).camera.distortion_model,
            DistortionModel::kEquidistant);
  const std::string unsaid = Replaced(four, "fisheye_model: 0\n", "");
  EXPECT_THAT(ErrorOf([&] { Import(unsaid); }),
              AllOf(HasSubstr("--model equidistant"), HasSubstr("--model plumb_bob")));
  CameraImportOptions options;
  options.model = DistortionModel::kEquidistant;
  EXPECT_EQ(Import(unsaid, options).camera.distortion_model, DistortionModel::kEquidistant);
}

TEST(ImportCamera, ReadsAMessageOfRos) {
  const ImportedCamera imported = Import(kCameraInfo);
  EXPECT_EQ(imported.format, "a ROS camera_info message");
  ExpectTheSampleCamera(imported.camera);
  const std::string ros1 = Replaced(Replaced(kCameraInfo, "\nd: ", "\nD: "), "\nk: ", "\nK: ");
  ExpectTheSampleCamera(Import(ros1).camera);
}

TEST(ImportCamera, RectifiedImagesHaveTheProjectionMatrixAndNoDistortion) {
  CameraImportOptions options;
  options.rectified = true;
  const CameraModel camera = Import(kCameraInfo, options).camera;
  EXPECT_EQ(camera.fx, 571.0);
  EXPECT_EQ(camera.fy, 572.0);
  EXPECT_EQ(camera.cx, 323.5);
  EXPECT_EQ(camera.cy, 237.5);
  EXPECT_THAT(camera.distortion, ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(ErrorOf([&] { Import(kFileStorage, options); }), HasSubstr("no projection matrix"));
}

TEST(ImportCamera, ReadsDumpsOfPythonScripts) {
  EXPECT_THAT(ErrorOf([] { Import(kPythonDump); }), HasSubstr("add --size WIDTHxHEIGHT"));
  CameraImportOptions options;
  options.size_px = {640, 480};
  options.name = "belly";
  const ImportedCamera imported = Import(kPythonDump, options);
  ExpectTheSampleCamera(imported.camera);
  EXPECT_EQ(imported.camera.name, "belly");
}

TEST(ImportCamera, ReadsOneCameraOfAStereoPair) {
  const std::string stereo =
      "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 598., 0., 322., 0., 597., 238., 0., 0., 1. ]\n"
      "D1: !!opencv-matrix\n   rows: 1\n   cols: 14\n   dt: d\n"
      "   data: [ -0.25, 0.06, 0.0008, -0.0005, 0.01, 0.1, 0.2, 0.3, 0., 0., 0., 0., 0., 0. ]\n"
      "M2: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nD2: [0, 0, 0, 0, 0]\n";
  CameraImportOptions options;
  options.size_px = {640, 480};
  EXPECT_THAT(ErrorOf([&] { Import(stereo, options); }), HasSubstr("choose one with --camera 1"));
  options.camera = "1";
  const CameraModel camera = Import(stereo, options).camera;
  EXPECT_EQ(camera.distortion_model, DistortionModel::kRationalPolynomial);
  EXPECT_THAT(camera.distortion, ElementsAre(-0.25, 0.06, 0.0008, -0.0005, 0.01, 0.1, 0.2, 0.3));
  EXPECT_THAT(ErrorOf([&] { Import(Replaced(stereo, "0.3, 0.,", "0.3, 0.7,"), options); }), HasSubstr("thin prism"));
}

TEST(ImportCamera, ReadsCameraYamlItself) {
  EXPECT_EQ(Import(testing_io::kCameraYaml).format, "camera.yaml");
  EXPECT_EQ(Import(testing_io::kCameraYaml).camera.fx, 598.3);
}

struct BrokenFile {
  const char* name;
  const char* text;
  const char* from;
  const char* to;
  const char* where;
  const char* reason;
};
std::ostream& operator<<(std::ostream& out, const BrokenFile& broken) { return out << broken.name; }

class BrokenImport : public ::testing::TestWithParam<BrokenFile> {};

TEST_P(BrokenImport, NamesFileLineAndReason) {
  const std::string text = Replaced(GetParam().text, GetParam().from, GetParam().to);
  EXPECT_THAT(ErrorOf([&] { Import(text); }), AllOf(StartsWith(GetParam().where), HasSubstr(GetParam().reason)));
}

const BrokenFile kBrokenFiles[] = {
    {"Omni", kCamchain, "pinhole", "omni", "dir/calib.yaml:6: ", "--models pinhole-radtan"},
    {"Fov", kCamchain, "radtan", "fov", "dir/calib.yaml:8: ", "distortion_model 'fov' cannot be used"},
    {"ThreeIntrinsics", kCamchain, ", 246.0]", "]", "dir/calib.yaml:9: ", "intrinsics must have 4 numbers but has 3"},
    {"NoResolution", kCamchain, "resolution", "size", "dir/calib.yaml: ", "'resolution' is missing"},
    {"OneSide", kCamchain, "[752, 480]", "[752]", "dir/calib.yaml:10: ", "resolution must be [width, height]"},
    {"CameraTwice", kCamchain, "  rostopic: /cam0/image_raw\n", "cam0: {}\n",
     "dir/calib.yaml:11: ", "'cam0' is given twice"},
    {"Shape", kFileStorage, "rows: 3", "rows: 2", "dir/calib.yaml:6: ", "rows x cols"},
    {"Skew", kFileStorage, "5.98e+02, 0.", "5.98e+02, 2.", "dir/calib.yaml:6: ", "has skew"},
    {"NoDistortion", kFileStorage, "distortion_coefficients", "lens", "dir/calib.yaml: ", "no distortion coefficients"},
    {"Binned", kCameraInfo, "binning_x: 0", "binning_x: 2", "dir/calib.yaml:11: ", "images are binned"},
    {"Cropped", kCameraInfo, "y_offset: 0", "y_offset: 8", "dir/calib.yaml:13: ", "a part of the sensor"},
    {"Uncalibrated", kCameraInfo, "[598.0", "[0.0", "dir/calib.yaml:8: ", "was not calibrated"},
    {"UnknownLens", kCameraInfo, "plumb_bob", "brown_conrady", "dir/calib.yaml:6: ", "cannot be used"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BrokenImport, ::testing::ValuesIn(kBrokenFiles),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CameraYaml, NamesTheCommandThatConvertsOtherFormats) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { ParseCameraYaml(text, "hall/camera.yaml"); });
  };
  const std::string command = "'floorloc-mapbuilder import-camera hall/camera.yaml --out hall'";
  EXPECT_THAT(error(kCamchain), AllOf(StartsWith("hall/camera.yaml: is a camchain of Kalibr"), HasSubstr(command)));
  EXPECT_THAT(error(kFileStorage), AllOf(HasSubstr("is a file of OpenCV's FileStorage"), HasSubstr(command)));
  EXPECT_THAT(error(kCameraInfo), AllOf(HasSubstr("is a ROS camera_info message"), HasSubstr(command)));
  EXPECT_THAT(error(kPythonDump), AllOf(HasSubstr("is a camera matrix under other names"), HasSubstr(command)));
  EXPECT_THAT(ErrorOf([] { ParseCameraYaml(kCamchain, "camera.yaml"); }), HasSubstr("--out .'"));
}

TEST(CameraYaml, OpenCvsTagsDoNoHarmWhereEverythingElseIsThere) {
  const std::string text =
      Replaced(Replaced(kFileStorage, "---\n", "---\ndistortion_model: plumb_bob\n"), "fisheye_model: 0\n", "");
  ExpectTheSampleCamera(ParseCameraYaml(text, "camera.yaml"));
}

}  // namespace
}  // namespace floorloc
