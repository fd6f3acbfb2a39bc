// SPDX-License-Identifier: Apache-2.0
// Errors in a survey are reported, skipped or refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/build/build_report.h"
#include "tests/mapbuilder/build/survey_copy.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <typename Reason>
auto Dropped(const std::string& filename, Reason reason) {
  return AllOf(Field(&DroppedFrame::filename, filename), Field(&DroppedFrame::reason, reason));
}

class BadInputTest : public SurveyCopyTest {
 protected:
  fs::path ImageFile(int number) const {
    char name[16];
    std::snprintf(name, sizeof(name), "%06d.jpg", number);
    return survey_ / "images" / name;
  }
  static std::string Name(const fs::path& image) { return "images/" + image.filename().string(); }
  static void Write(const fs::path& image, const cv::Mat& bgr) { ASSERT_TRUE(cv::imwrite(image.string(), bgr)); }

  BuildReport Build() { return BuildMap(options_); }
  std::string Error() {
    try {
      Build();
    } catch (const InputError& error) {
      EXPECT_FALSE(fs::exists(options_.out));
      return error.what();
    }
    return "built";
  }

  // Rows of frames.csv, to be modified and written back.
  std::vector<std::string> Rows() const {
    std::istringstream text(ReadTextFile(survey_ / "frames.csv"));
    std::vector<std::string> rows;
    for (std::string row; std::getline(text, row);) {
      rows.push_back(row);
    }
    return rows;
  }
  void WriteRows(const std::vector<std::string>& rows) const {
    std::string text;
    for (const std::string& row : rows) {
      text += row + "\n";
    }
    WriteFileAtomically(survey_ / "frames.csv", text);
  }

  // Applies `change` about the centre of the region of interest to the floor points of floor.yaml's homography.
  void ChangeHomography(const Eigen::Affine2d& change) const {
    FloorPlane floor = ReadSurvey(survey_).camera.floor;
    const Eigen::Vector2d center = floor.roi.Center();
    const Eigen::Affine2d about_center = Eigen::Translation2d(center) * change * Eigen::Translation2d(-center);
    floor.base_from_pixel = about_center.matrix() * floor.base_from_pixel;
    WriteFileAtomically(survey_ / "floor.yaml", FormatFloorYaml(floor));
  }
};

TEST_F(BadInputTest, AGoodSurveyHasNoWarnings) {
  const BuildReport report = Build();
  EXPECT_THAT(report.dropped, IsEmpty());
  EXPECT_THAT(report.warnings, IsEmpty());
}

TEST_F(BadInputTest, ABlurredImageIsLeftOut) {
  const auto blur = [this](int number, double sigma_px) {
    cv::Mat image = cv::imread(ImageFile(number).string());
    cv::GaussianBlur(image, image, {}, sigma_px);
    Write(ImageFile(number), image);
  };
  blur(5, 0.8);
  blur(9, 4.0);
  EXPECT_THAT(Build().dropped, ElementsAre(Dropped(Name(ImageFile(9)), "blurred")));
}

TEST_F(BadInputTest, BlurThatLastsIsNamed) {
  for (int i = 10; i < 22; ++i) {
    cv::Mat image = cv::imread(ImageFile(i).string());
    cv::GaussianBlur(image, image, {}, 3.0);
    Write(ImageFile(i), image);
  }
  EXPECT_THAT(Build().warnings,
              Contains(AllOf(HasSubstr("12 images from images/000010.jpg to images/000021.jpg"), HasSubstr("sharp"))));
}

TEST_F(BadInputTest, BadlyExposedImagesAreLeftOut) {
  Write(ImageFile(5), 0.05 * cv::imread(ImageFile(5).string()));
  Write(ImageFile(14), 4.0 * cv::imread(ImageFile(14).string()));
  EXPECT_THAT(Build().dropped,
              ElementsAre(Dropped(Name(ImageFile(5)), "too dark"), Dropped(Name(ImageFile(14)), "overexposed")));
}

TEST_F(BadInputTest, ACopyOfAnImageIsLeftOut) {
  fs::copy_file(ImageFile(3), ImageFile(12), fs::copy_options::overwrite_existing);
  EXPECT_THAT(Build().dropped, ElementsAre(Dropped(Name(ImageFile(12)), "the same image as an earlier one")));
}

TEST_F(BadInputTest, AnImageOfAnotherFloorIsLeftOut) {
  const SyntheticFloor other(77);
  Write(ImageFile(12), other.View(other.BaseForView(0.5, 0.4, 0.3)));
  EXPECT_THAT(Build().dropped, ElementsAre(Dropped(Name(ImageFile(12)), "matches no other frame")));
}

TEST_F(BadInputTest, ATruncatedImageIsLeftOut) {
  fs::resize_file(ImageFile(7), fs::file_size(ImageFile(7)) / 2);
  const BuildReport report = Build();
  EXPECT_EQ(report.frames, 28);
  EXPECT_EQ(report.frames_used, 27);
  EXPECT_THAT(report.dropped, ElementsAre(Dropped(Name(ImageFile(7)), HasSubstr("the image is cut off"))));
}

TEST_F(BadInputTest, AnImageOfAnotherCameraIsLeftOut) {
  Write(ImageFile(7), cv::Mat(480, 752, CV_8UC3, cv::Scalar::all(100)));
  EXPECT_THAT(Build().dropped,
              ElementsAre(Dropped(Name(ImageFile(7)), HasSubstr("is 752x480 but camera.yaml says 640x480"))));
}

TEST_F(BadInputTest, AMissingImageIsLeftOut) {
  fs::remove(ImageFile(7));
  const BuildReport report = Build();
  EXPECT_EQ(report.frames, 28);
  EXPECT_THAT(report.dropped, ElementsAre(Dropped(Name(ImageFile(7)), "image is missing")));
}

TEST_F(BadInputTest, ManyUnusableImagesAreRefused) {
  fs::remove(ImageFile(7));
  std::ofstream(ImageFile(8)) << "no image";
  EXPECT_THAT(Error(), AllOf(HasSubstr("000007.jpg: the image is missing"), HasSubstr("2 of 28 frames")));
}

TEST_F(BadInputTest, RowsOutOfOrderAreSortedByTime) {
  std::vector<std::string> rows = Rows();
  std::swap(rows[10], rows[11]);
  WriteRows(rows);
  const BuildReport report = Build();
  EXPECT_EQ(report.frames_used, 28);
  EXPECT_THAT(report.warnings, ElementsAre(AllOf(HasSubstr("frames.csv"), HasSubstr("1 rows are earlier"))));
  const std::vector<MapFrame> frames = MapDatabase(options_.out).ReadFrames();
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end(),
                             [](const MapFrame& a, const MapFrame& b) { return a.stamp_ns < b.stamp_ns; }));
  EXPECT_EQ(frames.size(), 28U);
}

TEST_F(BadInputTest, ARepeatedTimeStampIsLeftOut) {
  std::vector<std::string> rows = Rows();
  rows[11] = rows[10].substr(0, rows[10].find(',')) + rows[11].substr(rows[11].find(','));
  WriteRows(rows);
  EXPECT_THAT(Build().dropped, ElementsAre(Dropped(Name(ImageFile(10)), "time stamp is that of another frame")));
}

TEST_F(BadInputTest, AControlPointInAnImageThatIsLeftOutIsNamed) {
  fs::remove(ImageFile(7));
  std::string csv = "filename,u,v,x,y\n";
  for (const int i : {0, 7, 20}) {
    const Survey survey = ReadSurvey(survey_, BadFramePolicy::kSkip);
    const Pose2 pose = survey.ground_truth[static_cast<std::size_t>(i)].ToPose2();
    const Eigen::Vector2d p = pose * survey.camera.FloorFromRawPixel({320.0, 240.0});
    csv += Name(ImageFile(i)) + ",320,240," + std::to_string(p.x()) + "," + std::to_string(p.y()) + "\n";
  }
  WriteFileAtomically(survey_ / "control_points.csv", csv);
  EXPECT_THAT(Build().warnings, ElementsAre(HasSubstr("1 control points are in images that were left out")));
}

TEST_F(BadInputTest, OdometryOfAnotherClockIsRefused) {
  Trajectory odometry = ReadTum(survey_ / "odometry.tum");
  for (StampedPose3& row : odometry) {
    row.stamp_ns += 1'000'000'000'000;
  }
  WriteFileAtomically(survey_ / "odometry.tum", FormatTum(odometry));
  EXPECT_THAT(Error(), AllOf(HasSubstr("odometry.tum: "), HasSubstr("same clock")));
}

TEST_F(BadInputTest, OdometryThatIsWrittenOtherwiseIsRefused) {
  const Trajectory given = ReadTum(survey_ / "odometry.tum");
  const auto error_of = [&](const std::function<Pose2(const Pose2&)>& written) {
    Trajectory odometry;
    for (const StampedPose3& row : given) {
      odometry.push_back(StampedPose3::FromPose2(row.stamp_ns, written(row.ToPose2())));
    }
    WriteFileAtomically(survey_ / "odometry.tum", FormatTum(odometry));
    return Error();
  };
  EXPECT_THAT(error_of([](const Pose2& p) { return Pose2(p.y(), p.x(), p.yaw()); }),
              AllOf(HasSubstr("odometry.tum fits when"), HasSubstr("exchanged")));
  EXPECT_THAT(error_of([](const Pose2& p) { return Pose2(1e-3 * p.x(), 1e-3 * p.y(), p.yaw()); }),
              HasSubstr("fits when its positions are kilometres"));
}

TEST_F(BadInputTest, ASlightlyWrongScaleIsNamed) {
  ChangeHomography(Eigen::Affine2d(Eigen::Scaling(1.06)));
  EXPECT_THAT(Build().warnings, ElementsAre(AllOf(HasSubstr("floor.yaml"), HasSubstr("wrong scale"))));
}

TEST_F(BadInputTest, AWrongScaleIsRefused) {
  ChangeHomography(Eigen::Affine2d(Eigen::Scaling(0.75)));
  EXPECT_THAT(Error(), AllOf(HasSubstr("floor.yaml"), HasSubstr("motions 0.7"), HasSubstr("wrong scale")));
}

TEST_F(BadInputTest, ATurnedHomographyIsRefused) {
  ChangeHomography(Eigen::Affine2d(Eigen::Rotation2Dd(0.5 * std::numbers::pi)));
  EXPECT_THAT(Error(), AllOf(HasSubstr("floor.yaml"), HasSubstr("turned by 90 degrees")));
}

TEST_F(BadInputTest, AMirroredHomographyIsRefused) {
  ChangeHomography(Eigen::Affine2d(Eigen::Scaling(1.0, -1.0)));
  EXPECT_THAT(Error(), AllOf(HasSubstr("floor.yaml"), HasSubstr("mirrored")));
}

TEST_F(BadInputTest, MirroredImagesAreRefused) {
  const auto flip_all = [this](int code) {
    for (int i = 0; i < 28; ++i) {
      cv::Mat image = cv::imread(ImageFile(i).string());
      cv::flip(image, image, code);
      Write(ImageFile(i), image);
    }
  };
  flip_all(1);  // horizontally
  EXPECT_THAT(Error(), AllOf(HasSubstr("floor.yaml"), HasSubstr("mirrored")));
  flip_all(-1);  // both axes: with the first flip, only vertically
  EXPECT_THAT(Error(), AllOf(HasSubstr("floor.yaml"), HasSubstr("mirrored")));
}

TEST_F(BadInputTest, TheReportNamesWhatItFound) {
  fs::resize_file(ImageFile(7), fs::file_size(ImageFile(7)) / 2);
  ChangeHomography(Eigen::Affine2d(Eigen::Scaling(1.06)));
  const BuildReport report = Build();
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("cut off"), HasSubstr("WARNING      "), HasSubstr("wrong scale")));
  EXPECT_THAT(ToJson(report, true), AllOf(HasSubstr("cut off"), HasSubstr("\"warnings\""), HasSubstr("wrong scale")));
}

}  // namespace
}  // namespace floorloc
