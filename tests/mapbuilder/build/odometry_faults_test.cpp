// SPDX-License-Identifier: Apache-2.0
// Odometry that lies over a whole survey: what the images tie together is placed all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/simulation/simulate.h"
#include "tests/mapbuilder/build/half_camera.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Keeps the header and the frames that are not within three of the end of a lane, or two of its beginning: nobody saw
// the turns, and odometry alone ties one lane to the next.
std::string WithoutTurns(const std::string& csv) {
  std::istringstream in(csv);
  std::vector<std::string> rows;
  std::vector<double> times;
  std::string header;
  std::getline(in, header);
  for (std::string row; std::getline(in, row);) {
    rows.push_back(row);
    times.push_back(std::stod(row));
  }
  const auto starts_lane = [&](std::size_t i) { return i < times.size() && times[i] - times[i - 1] > 2.0; };
  std::string kept = header + "\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool ends = starts_lane(i + 1) || starts_lane(i + 2) || starts_lane(i + 3);
    const bool begins = i > 0 && (starts_lane(i) || (i > 1 && starts_lane(i - 1)));
    kept += ends || begins ? "" : rows[i] + "\n";
  }
  return kept;
}

class OdometryFaultsTest : public ::testing::Test {
 protected:
  OdometryFaultsTest() {
    static const TemporaryFolder recorded;
    static const int frames = [] {
      SimulateOptions options;
      options.out = recorded.path() / "survey";
      options.floor.source = "concrete";
      options.floor.width_m = 2.6;
      options.floor.height_m = 1.4;
      options.camera = HalfCamera();
      options.path.overlap = 0.3;
      options.path.odometry_rate_hz = 50.0;
      options.seed = 4;
      const int all = Simulate(options).frames;
      const std::filesystem::path csv = options.out / "frames.csv";
      WriteFileAtomically(csv, WithoutTurns(ReadTextFile(csv)));
      return all;
    }();
    EXPECT_GT(frames, 30);
    std::filesystem::copy(recorded.path() / "survey", survey_, std::filesystem::copy_options::recursive);
    options_.surveys = {survey_};
    options_.out = folder_.path() / "floor.floormap";
    options_.mosaic.resolution_m = 0.0028;
    options_.hold_out = false;
    odometry_ = ReadTum(survey_ / "odometry.tum");
  }

  // Replaces odometry by what `change` makes of each increment; it gets the share of the survey that is over.
  void ChangeIncrements(const std::function<Pose2(const Pose2&, double)>& change) {
    Trajectory changed = odometry_;
    for (std::size_t i = 1; i < odometry_.size(); ++i) {
      const Pose2 step = odometry_[i - 1].ToPose2().Between(odometry_[i].ToPose2());
      const double over = static_cast<double>(i) / static_cast<double>(odometry_.size());
      changed[i] = StampedPose3::FromPose2(odometry_[i].stamp_ns, changed[i - 1].ToPose2() * change(step, over));
    }
    WriteFileAtomically(survey_ / "odometry.tum", FormatTum(changed));
  }

  void StampEarlier(double seconds) {
    for (StampedPose3& row : odometry_) {
      row.stamp_ns -= std::llround(1e9 * seconds);
    }
    WriteFileAtomically(survey_ / "odometry.tum", FormatTum(odometry_));
  }

  // Largest difference between a frame's pose relative to the first frame and the ground truth's.
  double LargestErrorM() const {
    const Trajectory truth = ReadSurvey(survey_).ground_truth;
    const std::vector<MapFrame> frames = MapDatabase(options_.out).ReadFrames();
    const Pose2 true_first = InterpolatePose(truth, frames.front().stamp_ns).value();
    double largest = 0.0;
    for (const MapFrame& frame : frames) {
      const Pose2 found = frames.front().map_from_base.Between(frame.map_from_base);
      const Pose2 expected = true_first.Between(InterpolatePose(truth, frame.stamp_ns).value());
      largest = std::max(largest, (found.translation() - expected.translation()).norm());
    }
    return largest;
  }

  BuildReport ExpectAllPlaced() {
    BuildReport report = BuildMap(options_);
    EXPECT_EQ(report.frames_used, report.frames);
    EXPECT_LT(LargestErrorM(), 0.008);
    return report;
  }

  TemporaryFolder folder_;
  std::filesystem::path survey_ = folder_.path() / "survey";
  Trajectory odometry_;
  BuildOptions options_;
};

TEST_F(OdometryFaultsTest, AsItIsNothingIsNamed) {
  EXPECT_THAT(ExpectAllPlaced().warnings, Not(Contains(HasSubstr("odometry.tum: s"))));
}

TEST_F(OdometryFaultsTest, AnEncoderThatStands) {
  ChangeIncrements([](const Pose2& step, double over) { return over > 0.35 && over < 0.55 ? Pose2() : step; });
  EXPECT_THAT(ExpectAllPlaced().warnings,
              Contains(AllOf(HasSubstr("odometry.tum: stands still for"), HasSubstr("check the encoder"))));
}

TEST_F(OdometryFaultsTest, ImagesThatAreStampedLate) {
  StampEarlier(0.3);
  const BuildReport report = ExpectAllPlaced();
  EXPECT_THAT(report.warnings,
              Contains(AllOf(HasSubstr("images are stamped "), HasSubstr("ms late"), HasSubstr("compensated"))));
  EXPECT_LT(report.drift_m, 0.6) << "of odometry on the right clock";
}

// Wheels that slip in turns that nobody saw: no step can be proved false.
TEST_F(OdometryFaultsTest, TurnsThatAreWrong) {
  ChangeIncrements([](const Pose2& step, double) {
    return std::abs(step.yaw()) > 0.012 ? Pose2(step.x() + 0.002, step.y(), 0.8 * step.yaw()) : step;
  });
  ExpectAllPlaced();
}

}  // namespace
}  // namespace floorloc
