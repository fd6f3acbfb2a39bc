// SPDX-License-Identifier: Apache-2.0
// Odometry that jumps within a survey: the map is as good as without it, and the report names the jump.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "tests/mapbuilder/build/survey_copy.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class OdometryJumpsTest : public SurveyCopyTest {
 protected:
  OdometryJumpsTest() { options_.hold_out = false; }

  // Changes odometry from row `from` on; the second argument is the pose of that row.
  void Jump(std::size_t from, const std::function<Pose2(const Pose2&, const Pose2&)>& jump) const {
    Trajectory odometry = ReadTum(survey_ / "odometry.tum");
    const Pose2 start = odometry[from].ToPose2();
    for (std::size_t i = from; i < odometry.size(); ++i) {
      odometry[i] = StampedPose3::FromPose2(odometry[i].stamp_ns, jump(odometry[i].ToPose2(), start));
    }
    WriteFileAtomically(survey_ / "odometry.tum", FormatTum(odometry));
  }

  // Largest difference between a frame's pose relative to the first frame and the ground truth's.
  double LargestErrorM() const {
    const Trajectory truth = ReadSurvey(survey_).ground_truth;
    const std::vector<MapFrame> frames = MapDatabase(options_.out).ReadFrames();
    const auto relative = [](const Pose2& first, const Pose2& pose) { return first.Between(pose); };
    const Pose2 true_first = InterpolatePose(truth, frames.front().stamp_ns).value();
    double largest = 0.0;
    for (const MapFrame& frame : frames) {
      const Pose2 found = relative(frames.front().map_from_base, frame.map_from_base);
      const Pose2 expected = relative(true_first, InterpolatePose(truth, frame.stamp_ns).value());
      largest = std::max(largest, (found.translation() - expected.translation()).norm());
    }
    return largest;
  }

  void ExpectGoodMap() {
    const BuildReport report = BuildMap(options_);
    EXPECT_EQ(report.frames_used, 28);
    EXPECT_THAT(report.warnings, Contains(AllOf(HasSubstr("odometry.tum: step of"), HasSubstr("left out"))));
    EXPECT_LT(LargestErrorM(), 0.004);
    EXPECT_LT(report.drift_m, 0.1) << "of odometry without the jump";
  }
};

TEST_F(OdometryJumpsTest, ByTwoMetres) {
  Jump(17, [](const Pose2& pose, const Pose2&) { return Pose2(2.0, 0.0, 0.0) * pose; });
  ExpectGoodMap();
}

TEST_F(OdometryJumpsTest, BySixtyCentimetres) {
  Jump(10, [](const Pose2& pose, const Pose2&) { return Pose2(0.6, 0.0, 0.0) * pose; });
  ExpectGoodMap();
}

TEST_F(OdometryJumpsTest, ToTheOrigin) {
  Jump(17, [](const Pose2& pose, const Pose2& start) { return start.Inverse() * pose; });
  ExpectGoodMap();
}

TEST_F(OdometryJumpsTest, ThreeTimes) {
  Jump(6, [](const Pose2& pose, const Pose2&) { return Pose2(2.0, 0.0, 0.0) * pose; });
  Jump(13, [](const Pose2& pose, const Pose2&) { return Pose2(-0.6, 0.2, 0.5) * pose; });
  Jump(20, [](const Pose2& pose, const Pose2& start) { return start.Inverse() * pose; });
  ExpectGoodMap();
}

}  // namespace
}  // namespace floorloc
