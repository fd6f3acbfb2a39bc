// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/self_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/mounting.h"
#include "core/io/input_error.h"
#include "mapbuilder/self_calibration/camera_doubt.h"
#include "mapbuilder/simulation/simulated_camera.h"
#include "tests/mapbuilder/keypoints/floor_points.h"

namespace floorloc {
namespace {

// Twenty frames over a square metre by a camera with a wrong calibration.
class Survey20 {
 public:
  explicit Survey20(const CameraAdjustment& error) : true_camera_(MakeForwardCamera()), points_(4000, true, 7) {
    LoadedSurvey loaded;
    loaded.survey.camera = Adjusted(true_camera_, error);
    surveys.push_back(loaded);
    for (int i = 0; i < 20; ++i) {
      const bool back = i >= 10;
      truth.emplace_back(back ? 0.75 - 0.05 * (i - 10) : 0.05 * i, back ? 0.6 : 0.4,
                         (back ? 3.1 : 0.0) + 0.02 * (i % 3));
      frames.push_back(ObserveMiscalibrated(truth.back()));
      frames.back().info.filename = std::to_string(i);
      placement.map_from_base.emplace_back(truth.back() * Pose2(i == 0 ? 0.0 : 5e-4 * (i % 3), 0.0, 0.0));
      if (i > 0) {
        Link link;
        link.first = i - 1;
        link.second = i;
        placement.links.push_back(link);
      }
    }
    options.registration.resolution_m = true_camera_.floor.resolution_m;
  }

  SelfCalibration Run() {
    CalibratedFrames result = SelfCalibrate({surveys, frames}, placement, options);
    surveys = result.set.surveys;
    frames = result.set.frames;
    placement = result.placement;
    return result.calibration;
  }

  // Largest error of side lengths of the region of interest by the survey's camera, independent of rigid motion.
  double ShapeErrorM() const {
    const FloorCamera& camera = surveys.front().survey.camera;
    const auto floor_point = [&](double x, double y) {
      return camera.FloorFromRawPixel(true_camera_.RawPixelFromFloor({x, y}));
    };
    const RectM& roi = true_camera_.floor.roi;
    const double width =
        (floor_point(roi.x_min, roi.y_min) - floor_point(roi.x_min, roi.y_max)).norm() - roi.height_m();
    const double far_width =
        (floor_point(roi.x_max, roi.y_min) - floor_point(roi.x_max, roi.y_max)).norm() - roi.height_m();
    const double length = (floor_point(roi.x_min, 0.0) - floor_point(roi.x_max, 0.0)).norm() - roi.width_m();
    return std::max({std::abs(width), std::abs(far_width), std::abs(length)});
  }

  std::vector<LoadedSurvey> surveys;
  std::vector<BuildFrame> frames;
  std::vector<Pose2> truth;
  Placement placement;
  SelfCalibrationOptions options;

 private:
  BuildFrame ObserveMiscalibrated(const Pose2& map_from_base) {
    BuildFrame frame = points_.Observe(map_from_base, 1e-4);
    Features kept;
    for (std::size_t i = 0; i < frame.features.keypoints.size(); ++i) {
      Keypoint k = frame.features.keypoints[i];
      if (!true_camera_.floor.roi.Contains(k.Position())) {
        continue;
      }
      const Eigen::Vector2d p =
          surveys.front().survey.camera.FloorFromRawPixel(true_camera_.RawPixelFromFloor(k.Position()));
      k.x_m = static_cast<float>(p.x());
      k.y_m = static_cast<float>(p.y());
      kept.keypoints.push_back(k);
      kept.descriptors.push_back(frame.features.descriptors.row(static_cast<int>(i)));
    }
    frame.features = kept;
    return frame;
  }

  FloorCamera true_camera_;
  FloorPoints points_;
};

CameraAdjustment Error(CameraUnknown unknown, double value) {
  CameraAdjustment error = CameraAdjustment::Zero();
  error[static_cast<int>(unknown)] = value;
  return error;
}

TEST(CameraDoubtTest, SaysHowFarImagesWouldMoveThePoses) {
  const auto doubt = [](double error) {
    const Survey20 survey(Error(CameraUnknown::kPitch, error) + Error(CameraUnknown::kRoll, error));
    return DoubtCameras({{survey.surveys, survey.frames}, survey.placement, {}}, survey.options);
  };
  EXPECT_LT(doubt(0.0).pose_rms_m, 5e-4);
  EXPECT_LT(doubt(0.0).camera_px, 1.0);
  EXPECT_GT(doubt(0.008).pose_rms_m, 1e-3);
  EXPECT_GT(doubt(0.008).camera_px, 3.0);
}

TEST(SelfCalibrationTest, FindsPitchRollAndDistortion) {
  CameraAdjustment error =
      Error(CameraUnknown::kPitch, 0.008) + Error(CameraUnknown::kRoll, -0.005) + Error(CameraUnknown::kK1, 0.01);
  Survey20 survey(error);
  const double before = survey.ShapeErrorM();
  ParseCameraUnknowns({"mounting", "distortion"}, &survey.options);
  const SelfCalibration found = survey.Run();
  ASSERT_EQ(found.cameras.size(), 1U);
  EXPECT_GT(before, 2e-3);
  EXPECT_LT(survey.ShapeErrorM(), 4e-4);
  EXPECT_LT(found.rms_after_m, 0.5 * found.rms_before_m);
  for (const CameraUnknown unknown : {CameraUnknown::kPitch, CameraUnknown::kRoll}) {
    const int i = static_cast<int>(unknown);
    EXPECT_NEAR(found.cameras[0].change[i], -error[i], 5.0 * found.cameras[0].sigma[i] + 2e-4) << i;
    EXPECT_GT(found.cameras[0].sigma[i], 0.0);
    EXPECT_LT(found.cameras[0].sigma[i], 4e-3);
  }
  EXPECT_EQ(found.cameras[0].change[static_cast<int>(CameraUnknown::kHeight)], 0.0);  // was not requested
  for (std::size_t i = 0; i < survey.truth.size(); ++i) {
    const Eigen::Vector2d off = survey.placement.map_from_base[i]->translation() - survey.truth[i].translation();
    EXPECT_LT(off.norm(), 5e-3) << i;
  }
}

TEST(SelfCalibrationTest, AKnownDistanceFixesTheHeight) {
  Survey20 survey(Error(CameraUnknown::kHeight, 0.02));
  const double before = survey.ShapeErrorM();
  const FloorCamera camera = MakeForwardCamera();
  const auto pixel_of = [&](const Eigen::Vector2d& map_point, std::size_t frame) {
    return camera.RawPixelFromFloor(survey.truth[frame].Inverse() * map_point);
  };
  const Eigen::Vector2d a = survey.truth[0] * camera.floor.roi.Center();
  const Eigen::Vector2d b = survey.truth[9] * camera.floor.roi.Center();
  survey.surveys[0].survey.known_distances = {
      {"0", pixel_of(a, 0), "9", pixel_of(b, 9), (a - b).norm()},
      {"0", pixel_of(a, 0), "0", pixel_of(a + Eigen::Vector2d(0.0, 0.1), 0), 0.1}};
  ParseCameraUnknowns({"height"}, &survey.options);
  const SelfCalibration found = survey.Run();
  EXPECT_GT(before, 4e-3);
  EXPECT_LT(survey.ShapeErrorM(), 6e-4);
  EXPECT_NEAR(found.cameras[0].change[static_cast<int>(CameraUnknown::kHeight)], -0.0196, 1.5e-3);
}

// A length of 20 mm, known to 1 mm, tells the height as well as the calibration given (5 %). When it says 10 % less,
// the two meet halfway, however many rounds the adjustment takes.
TEST(SelfCalibrationTest, ThePriorIsOnTheWholeChangeNotOnEachRounds) {
  Survey20 survey(Error(CameraUnknown::kHeight, 0.1));
  const FloorCamera camera = MakeForwardCamera();
  const Eigen::Vector2d a = camera.floor.roi.Center();
  const double length_m = 0.02;
  survey.surveys[0].survey.known_distances = {
      {"0", camera.RawPixelFromFloor(a), "0", camera.RawPixelFromFloor(a + Eigen::Vector2d(0.0, length_m)), length_m}};
  ParseCameraUnknowns({"height"}, &survey.options);
  const double change = survey.Run().cameras[0].change[static_cast<int>(CameraUnknown::kHeight)];
  EXPECT_LT(change, -0.03);
  EXPECT_GT(change, -0.06);
}

TEST(SelfCalibrationTest, TheNumberOfThreadsChangesNothing) {
  const auto run = [](int threads) {
    Survey20 survey(Error(CameraUnknown::kPitch, 0.008));
    ParseCameraUnknowns({"mounting", "distortion"}, &survey.options);
    survey.options.registration.run.threads = threads;
    std::vector<double> numbers;
    const CameraAdjustment change = survey.Run().cameras[0].change;
    numbers.assign(change.begin(), change.end());
    for (const std::optional<Pose2>& pose : survey.placement.map_from_base) {
      numbers.insert(numbers.end(), {pose->x(), pose->y(), pose->yaw()});
    }
    return numbers;
  };
  const std::vector<double> alone = run(1);
  EXPECT_EQ(run(2), alone);
  EXPECT_EQ(run(4), alone);
}

TEST(SelfCalibrationTest, HeightWithoutAScaleConstraintIsRefused) {
  Survey20 survey(CameraAdjustment::Zero());
  ParseCameraUnknowns({"height"}, &survey.options);
  EXPECT_THROW(survey.Run(), InputError);
}

TEST(SelfCalibrationTest, NothingAskedForChangesNothing) {
  Survey20 survey(Error(CameraUnknown::kPitch, 0.01));
  const Pose2 before = *survey.placement.map_from_base[7];
  ParseCameraUnknowns({"none"}, &survey.options);
  EXPECT_TRUE(survey.Run().cameras.empty());
  EXPECT_EQ(survey.placement.map_from_base[7]->x(), before.x());
}

TEST(SelfCalibrationTest, ByDefaultItEstimatesWhatTheImagesTell) {
  const CameraAdjustment error =
      Error(CameraUnknown::kPitch, 0.012) + Error(CameraUnknown::kRoll, -0.009) + Error(CameraUnknown::kP1, 0.002);
  Survey20 survey(error);
  const FloorCamera given = survey.surveys[0].survey.camera;
  const double before = survey.ShapeErrorM();
  const SelfCalibration found = survey.Run();
  ASSERT_EQ(found.given_up, "");
  const CalibratedCamera& camera = found.cameras[0];
  EXPECT_LT(survey.ShapeErrorM(), 0.25 * before);
  EXPECT_EQ(camera.given.floor.base_from_pixel, given.floor.base_from_pixel);
  EXPECT_NEAR(camera.change[static_cast<int>(CameraUnknown::kPitch)], -0.012, 4e-3);
  EXPECT_EQ(camera.change[static_cast<int>(CameraUnknown::kHeight)], 0.0) << "nothing tells the scale";
  EXPECT_GT(camera.camera.camera.sigma_px, 0.0);
  EXPECT_GT(camera.camera.floor.offset_sigma_m, 0.0);
}

// Three frames tell a lens with tilt and distortion not at all.
TEST(SelfCalibrationTest, ByDefaultItLeavesTheRestAsGiven) {
  Survey20 survey(CameraAdjustment::Zero());
  for (std::size_t i = 3; i < survey.frames.size(); ++i) {
    survey.placement.map_from_base[i].reset();
  }
  const std::vector<Keypoint> keypoints = survey.frames[1].features.keypoints;
  const SelfCalibration found = survey.Run();
  EXPECT_FALSE(found.cameras[0].unobserved.empty());
  for (const CameraUnknown unknown : found.cameras[0].unobserved) {
    EXPECT_EQ(found.cameras[0].change[static_cast<int>(unknown)], 0.0);
    EXPECT_EQ(found.cameras[0].sigma[static_cast<int>(unknown)], 0.0);
  }
}

TEST(SelfCalibrationTest, AnAutomaticCalibrationThatDoesNotFitIsGivenUp) {
  Survey20 survey(CameraAdjustment::Zero());
  survey.options.max_scatter_px = 1e-3;
  const std::vector<Keypoint> keypoints = survey.frames[7].features.keypoints;
  const Pose2 before = *survey.placement.map_from_base[7];
  const SelfCalibration found = survey.Run();
  EXPECT_THAT(found.given_up, testing::HasSubstr("scatter"));
  EXPECT_EQ(survey.placement.map_from_base[7]->x(), before.x());
  EXPECT_EQ(survey.frames[7].features.keypoints[3].x_m, keypoints[3].x_m);
  EXPECT_EQ(survey.frames[7].mounting_error.rotation_rad.norm(), 0.0);
}

// Without its tilt, a frame of a vibrating camera puts floor points where they are not.
TEST(SelfCalibrationTest, KeypointsAreCorrectedForEachFramesTilt) {
  Survey20 survey(CameraAdjustment::Zero());
  ParseCameraUnknowns({"mounting"}, &survey.options);
  survey.options.tilt_rad = 5e-3;
  const Eigen::Vector3d center = survey.surveys[0].survey.camera.CameraCenter();
  const Eigen::Vector4d tilt(0.002, -0.0015, 0.0, 0.0);
  const std::vector<Keypoint> truth = survey.frames[5].features.keypoints;
  for (Keypoint& k : survey.frames[5].features.keypoints) {
    const Eigen::Vector2d seen = k.Position() - MountingJacobian(center, k.Position()) * tilt;
    k.x_m = static_cast<float>(seen.x());
    k.y_m = static_cast<float>(seen.y());
  }
  survey.Run();
  EXPECT_NEAR(survey.frames[5].mounting_error.rotation_rad.x(), 0.002, 7e-4);
  EXPECT_NEAR(survey.frames[5].mounting_error.rotation_rad.y(), -0.0015, 7e-4);
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector2d in_map =
        *survey.placement.map_from_base[5] * survey.frames[5].features.keypoints[i].Position();
    squares += (in_map - survey.truth[5] * truth[i].Position()).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(truth.size())), 7e-4);
}

TEST(SelfCalibrationTest, UnknownNamesAreRefused) {
  SelfCalibrationOptions options;
  EXPECT_THROW(ParseCameraUnknowns({"colour"}, &options), std::invalid_argument);
  EXPECT_THROW(ParseCameraUnknowns({"auto", "mounting"}, &options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
