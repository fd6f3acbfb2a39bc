// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/io/text_file.h"
#include "mapbuilder/simulation/simulated_camera.h"
#include "mapbuilder/simulation/simulated_path.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// A minute on 2.6 x 1.8 m with all kinds of events and exact sensors.
PathOptions EventfulDrive() {
  PathOptions options;
  options.type = PathType::kDrive;
  options.roi = MakeDownwardCamera().floor.roi;
  options.frames = 241;
  options.fps = 4.0;
  options.odometry = options.odometry.Scaled(0.0);
  options.odometry_rate_hz = 50.0;
  options.imu_rate_hz = 100.0;
  options.imu = options.imu.Scaled(0.0);
  options.drive.speed_variation = 0.5;
  options.drive.stops = 2;
  options.drive.kidnaps_s = {20.0, 40.0};
  return options;
}

std::int64_t StampOf(const Trajectory& trajectory, std::size_t index) { return trajectory[index].stamp_ns; }

// Largest difference between odometry's and true motions of consecutive rows whose time `counts` selects.
template <typename Counts>
double LargestDisagreement(const SimulatedPath& path, Counts counts) {
  double worst = 0.0;
  for (std::size_t i = 1; i < path.odometry.size(); ++i) {
    const Pose2 by_odometry = path.odometry[i - 1].ToPose2().Between(path.odometry[i].ToPose2());
    const Pose2 real = path.truth[i - 1].ToPose2().Between(path.truth[i].ToPose2());
    if (counts(SimulatedSeconds(path.odometry[i].stamp_ns))) {
      worst = std::max(worst, by_odometry.Between(real).Log().norm());
    }
  }
  return worst;
}

TEST(SimulatedDrive, PerfectOdometryIsTheTruthExceptAtKidnaps) {
  const SimulatedPath path = PlanPath(EventfulDrive());
  const auto is_kidnap = [](double time_s) { return std::abs(time_s - 20.0) < 1e-6 || std::abs(time_s - 40.0) < 1e-6; };
  EXPECT_LT(LargestDisagreement(path, [&](double time_s) { return !is_kidnap(time_s); }), 1e-6);
  for (const double kidnap_s : {20.0, 40.0}) {
    const auto at = [=](double time_s) { return std::abs(time_s - kidnap_s) < 1e-6; };
    EXPECT_GT(LargestDisagreement(path, at), 0.3) << "at " << kidnap_s << " s";
  }
}

TEST(SimulatedDrive, StampsOdometryAtItsOwnRateToTheLastFrame) {
  PathOptions options = EventfulDrive();
  options.odometry_rate_hz = 30.0;
  const SimulatedPath path = PlanPath(options);
  ASSERT_EQ(path.odometry.size(), 1801U);
  EXPECT_EQ(StampOf(path.odometry, 0), path.frames.front().stamp_ns);
  EXPECT_EQ(StampOf(path.odometry, 1) - StampOf(path.odometry, 0), 33'333'333);
  EXPECT_GE(path.odometry.back().stamp_ns, path.frames.back().stamp_ns);
  EXPECT_EQ(path.truth.size(), path.odometry.size());
}

TEST(SimulatedDrive, DenseTruthPassesThroughTheFrames) {
  const SimulatedPath path = PlanPath(EventfulDrive());
  for (std::size_t i = 0; i < path.frames.size(); i += 2) {  // multiples of half a second are odometry stamps
    const auto row = std::find_if(path.truth.begin(), path.truth.end(),
                                  [&](const StampedPose3& pose) { return pose.stamp_ns == path.frames[i].stamp_ns; });
    ASSERT_NE(row, path.truth.end());
    EXPECT_LT(row->ToPose2().Between(path.frames[i].map_from_base).Log().norm(), 1e-6);
  }
}

TEST(SimulatedDrive, GyroIntegratesToTheYawIncludingTheTurnsOfKidnaps) {
  const SimulatedPath path = PlanPath(EventfulDrive());
  ASSERT_EQ(path.imu.size(), 6000U);
  double yaw = path.truth.front().ToPose2().yaw();
  double worst = 0.0;
  for (std::size_t i = 0; i < path.imu.size(); ++i) {
    yaw += 0.01 * path.imu[i].angular_velocity.z();
    const double time_s = 0.01 * static_cast<double>(i + 1);
    const bool lifted = std::abs(time_s - 20.0) < 0.51 || std::abs(time_s - 40.0) < 0.51;
    if (i % 2 == 1 && !lifted) {
      worst = std::max(worst, std::abs(WrapAngle(yaw - path.truth[(i + 1) / 2].ToPose2().yaw())));
    }
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(SimulatedDrive, AccelerationsIntegrateToTheVelocities) {
  PathOptions options = EventfulDrive();
  options.drive.kidnaps_s.clear();
  const SimulatedPath path = PlanPath(options);
  const auto velocity_at = [&path](std::size_t row) {
    return Eigen::Vector2d((path.truth[row + 1].translation_m - path.truth[row - 1].translation_m).head<2>() / 0.04);
  };
  double yaw = path.truth.front().ToPose2().yaw();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  double worst = 0.0;
  for (std::size_t i = 0; i + 4 < path.imu.size(); ++i) {
    const double turn = 0.01 * path.imu[i].angular_velocity.z();
    velocity += Pose2(0.0, 0.0, yaw + 0.5 * turn) * Eigen::Vector2d(0.01 * path.imu[i].acceleration.head<2>());
    yaw += turn;
    if (i == 1) {
      velocity = velocity_at(1);
    } else if (i % 2 == 1) {
      worst = std::max(worst, (velocity - velocity_at((i + 1) / 2)).norm());
    }
    ASSERT_NEAR(path.imu[i].acceleration.z(), kGravity, 1e-9);
  }
  EXPECT_LT(worst, 0.02);  // velocity_at() averages over 40 ms
}

TEST(SimulatedDrive, StandsStillAtStopsAndVariesItsSpeedElsewhere) {
  const SimulatedPath path = PlanPath(EventfulDrive());
  double fastest = 0.0;
  for (const PathFrame& frame : path.frames) {
    const double time_s = SimulatedSeconds(frame.stamp_ns);
    const bool stands = std::any_of(path.events.begin(), path.events.end(), [time_s](const DriveEvent& event) {
      return time_s >= event.time_s && time_s <= event.time_s + event.duration_s;
    });
    if (stands) {
      EXPECT_LT(frame.twist.norm(), 1e-9) << "at " << time_s << " s";
    }
    fastest = std::max(fastest, frame.twist.head<2>().norm());
  }
  EXPECT_EQ(path.events.size(), 4U);
  EXPECT_GT(fastest, 1.15 * 0.3);
  EXPECT_LT(fastest, 1.6 * 0.3);
}

TEST(SimulatedDrive, SlippingWheelsReportMotionThatIsNotThere) {
  PathOptions options = EventfulDrive();
  options.drive.kidnaps_s.clear();
  options.drive.slips = 3;
  const SimulatedPath path = PlanPath(options);
  const auto slips = [&path](double time_s) {
    return std::any_of(path.events.begin(), path.events.end(), [time_s](const DriveEvent& event) {
      return event.name == "slip" && time_s > event.time_s && time_s < event.time_s + event.duration_s + 0.02;
    });
  };
  EXPECT_EQ(std::count_if(path.events.begin(), path.events.end(), [](const auto& e) { return e.name == "slip"; }), 3);
  EXPECT_LT(LargestDisagreement(path, [&](double time_s) { return !slips(time_s); }), 1e-6);
  EXPECT_GT(LargestDisagreement(path, slips), 0.001);
}

TEST(SimulatedDrive, ImuErrorsAreThoseAsked) {
  PathOptions options = EventfulDrive();
  options.drive.kidnaps_s.clear();
  const SimulatedPath perfect = PlanPath(options);
  options.imu.gyro_noise = 0.01;
  options.imu.accel_bias = 0.5;
  const SimulatedPath noisy = PlanPath(options);
  double sum = 0.0;
  for (std::size_t i = 0; i < noisy.imu.size(); ++i) {
    const Eigen::Vector3d error = noisy.imu[i].angular_velocity - perfect.imu[i].angular_velocity;
    sum += error.squaredNorm() / 3.0;
    const Eigen::Vector3d bias = noisy.imu[i].acceleration - perfect.imu[i].acceleration;
    ASSERT_LT((bias - (noisy.imu[0].acceleration - perfect.imu[0].acceleration)).norm(), 1e-9);
    ASSERT_GT(bias.norm(), 0.05);
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(noisy.imu.size())), 0.01, 0.0005);
}

TEST(SimulatedDrive, KidnapsNeitherLeaveTheFloorNorStandNearby) {
  PathOptions options = EventfulDrive();
  options.drive.kidnaps_s = {5.0, 15.0, 25.0, 35.0, 45.0};
  for (options.seed = 1; options.seed <= 5; ++options.seed) {
    for (const StampedPose3& row : PlanPath(options).truth) {
      for (const double x : {options.roi.x_min, options.roi.x_max}) {
        const Eigen::Vector2d corner = row.ToPose2() * Eigen::Vector2d(x, options.roi.y_max);
        ASSERT_TRUE((RectM{0.0, options.floor_width_m, 0.0, options.floor_height_m}).Contains(corner));
      }
    }
  }
}

TEST(SimulatedDrive, RefusesWhatCannotHappen) {
  PathOptions options = EventfulDrive();
  options.drive.kidnaps_s = {61.0};
  EXPECT_THROW(PlanPath(options), std::invalid_argument);
  options.drive.kidnaps_s = {20.0, 10.0};
  EXPECT_THROW(PlanPath(options), std::invalid_argument);
  options = EventfulDrive();
  options.drive.speed_variation = 1.5;
  EXPECT_THROW(PlanPath(options), std::invalid_argument);
}

TEST(Simulate, WritesWhatARobotRecords) {
  const TemporaryFolder folder;
  SimulateOptions options = SyntheticFloor().SurveyOptions(folder.path() / "a");
  options.path = EventfulDrive();
  options.path.frames = 9;
  options.path.drive = {.speed_variation = 0.2, .kidnaps_s = {1.0}};
  Simulate(options);
  const Survey survey = ReadSurvey(options.out);
  EXPECT_EQ(survey.frames.size(), 9U);
  EXPECT_EQ(survey.odometry.size(), 101U);
  EXPECT_EQ(survey.imu.size(), 200U);
  EXPECT_EQ(ReadTum(options.out / "groundtruth_dense.tum").size(), 101U);
  EXPECT_EQ(ReadTextFile(options.out / "events.csv"),
            "timestamp,duration,event\n1700000001.000000000,0.000000000,kidnap\n");
  options.out = folder.path() / "b";
  Simulate(options);
  for (const char* name : {"imu.csv", "odometry.tum", "groundtruth_dense.tum", "images/000008.jpg"}) {
    EXPECT_EQ(ReadTextFile(folder.path() / "a" / name), ReadTextFile(folder.path() / "b" / name)) << name;
  }
}

}  // namespace
}  // namespace floorloc
