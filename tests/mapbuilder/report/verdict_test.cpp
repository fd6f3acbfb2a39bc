// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mapbuilder/report/made_up_map.h"

namespace floorloc {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Verdict VerdictOf(const MapEvidence& evidence) { return AssessMap(evidence, MeasureQuality(evidence, {})); }

TEST(VerdictTest, AGoodMapIsTrusted) {
  const Verdict verdict = VerdictOf(MakeMapEvidence());
  EXPECT_EQ(verdict.trust, Trust::kTrust);
  EXPECT_THAT(verdict.reasons, IsEmpty());
  EXPECT_THAT(verdict.facts, Contains(HasSubstr("4 of 4 frames")));
}

TEST(VerdictTest, AnUntestedMapIsNotSimplyTrusted) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.held_out.clear();
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
}

TEST(VerdictTest, AMapThatShowsAPartOfTheRobotIsNotToBeUsed) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.copies = {{0, 400, 0.11, {}}};
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kResurvey);
  EXPECT_EQ(verdict.headline, "Do not use this map yet: build it again with a mask");
  EXPECT_THAT(verdict.reasons.front(), HasSubstr("11 % of the view repeats in the mosaic"));
}

TEST(VerdictTest, AHoleIsToBeInspected) {
  const Verdict verdict = VerdictOf(
      MakeMapEvidence([](const Eigen::Vector2d& view) { return (view - Eigen::Vector2d(1.6, 1.2)).norm() > 0.5; }));
  EXPECT_EQ(verdict.trust, Trust::kInspect);
  EXPECT_THAT(verdict.headline, HasSubstr("check one place"));
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("of floor was missed")));
}

TEST(VerdictTest, ALargelyPlainFloorIsToBeResurveyed) {
  MapEvidence evidence = MakeMapEvidence();
  ClearKeypoints({0.0, 1.6, 0.0, 2.4}, &evidence);
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kResurvey);
  EXPECT_THAT(verdict.reasons.front(), HasSubstr("too few keypoints"));
}

TEST(VerdictTest, AFloorOfTilesNeedsAPriorButNoNewSurvey) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.map.keypoints.distinctiveness.assign(evidence.map.keypoints.size(), 12);
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kInspect);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("a prior")));
}

TEST(VerdictTest, ByWhatTheFloorRepeatsItselfIsAFact) {
  MapEvidence evidence = MakeMapEvidence();
  MapLattice lattice;
  lattice.extent = evidence.map.info.extent;
  lattice.basis << 0.3, 0.0, 0.0, 0.2001;
  lattice.share = 0.92;
  lattice.residual_m = 3e-4;
  evidence.map.info.lattices = {lattice};
  EXPECT_THAT(VerdictOf(evidence).facts,
              Contains(HasSubstr("every 300.0 mm x 200.1 mm (92 % of its copies, 0.3 mm off)")));
  evidence.map.info.lattices[0].floor_share = 0.4;
  EXPECT_THAT(VerdictOf(evidence).facts,
              Contains(HasSubstr("itself on 40 % of it, x 0.0 to 3.2 m, y 0.0 to 2.4 m, every")));
  EXPECT_EQ(VerdictOf(evidence).trust, VerdictOf(MakeMapEvidence()).trust);
}

TEST(VerdictTest, AMapThatShowsWhatMovesWithTheCameraIsNotToBeUsed) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.masks = {{CameraMaskStatus::kFound, false, 0.13, 20, {}, {}}};
  Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kResurvey);
  EXPECT_THAT(verdict.headline, HasSubstr("build it again with a mask"));
  EXPECT_THAT(verdict.reasons.front(), HasSubstr("13.0 % of the images moves with the camera"));
  evidence.build.masks[0].share = 0.01;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
  evidence.build.masks[0].share = 0.13;
  evidence.build.masks[0].applied = true;
  verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kTrust);
  EXPECT_THAT(verdict.reasons, IsEmpty());
}

TEST(VerdictTest, HeldOutFramesDecide) {
  MapEvidence evidence = MakeMapEvidence();
  for (int i = 0; i < 16; ++i) {
    evidence.build.held_out.push_back(evidence.build.held_out.front());
  }
  evidence.build.held_out[0].status = "not_localized";
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect) << "its place is weak";
  for (std::size_t i = 0; i < 6; ++i) {
    evidence.build.held_out[i].status = "not_localized";
  }
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kResurvey);
  for (std::size_t i = 0; i < 6; ++i) {
    evidence.build.held_out[i].status = i < 2 ? "wrong" : "localized";
  }
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kResurvey);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("wrong pose")));
}

TEST(VerdictTest, AWrongPoseIsNotCountedAsNotLocalized) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.held_out.resize(1);
  evidence.build.held_out[0].status = "wrong";
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kResurvey);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("1 of 1 held-out frames were localized at a wrong pose")));
  EXPECT_THAT(verdict.reasons, Not(Contains(HasSubstr("not localized"))));
}

TEST(VerdictTest, AmbiguousHeldOutFramesCallForAPriorOnly) {
  MapEvidence evidence = MakeMapEvidence();
  for (HeldOutFrame& frame : evidence.build.held_out) {
    frame.status = "ambiguous";
  }
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kInspect);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("4 of 4 held-out frames fit at several places")));
}

TEST(VerdictTest, ManyUnmatchedOverlapsMeanAFoldedMap) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.overlapping_pairs = 100;
  evidence.build.unmatched_pairs = 15;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
  evidence.build.unmatched_pairs = 40;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kResurvey);
}

TEST(VerdictTest, AMapThatItsCamerasBendIsToBeBuiltAgain) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.camera_doubt = {2e-4, 4e-4, 3e-4, 0.4};
  EXPECT_EQ(VerdictOf(evidence).trust, VerdictOf(MakeMapEvidence()).trust);
  evidence.build.camera_doubt.pose_rms_m = 8e-4;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
  EXPECT_THAT(VerdictOf(evidence).reasons, Contains(HasSubstr("contradict the cameras' calibration")));
  evidence.build.camera_doubt.pose_rms_m = 1.9e-3;
  EXPECT_EQ(VerdictOf(evidence).headline, "Do not use this map yet: build it again with self-calibration");
  evidence.build.frames = 2 * evidence.build.frames_used;  // another reason
  EXPECT_EQ(VerdictOf(evidence).headline, "Do not use this map yet: survey again");
}

TEST(VerdictTest, AFloorThatRepeatsItselfNeedsOdometry) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.part_sizes = {evidence.build.frames * 7 / 10, evidence.build.frames * 3 / 10};
  evidence.build.kept_all = true;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
  evidence.build.repeats_unaided = true;
  EXPECT_EQ(VerdictOf(evidence).headline, "Do not use this map yet: survey again with odometry");
  EXPECT_THAT(VerdictOf(evidence).reasons.front(), HasSubstr("The floor repeats itself"));
  EXPECT_THAT(VerdictOf(evidence).reasons, Not(Contains(HasSubstr("survey the floor between them"))));
  evidence.build.part_sizes = {evidence.build.frames * 9 / 10};
  EXPECT_EQ(VerdictOf(evidence).trust, VerdictOf(MakeMapEvidence()).trust);
}

TEST(VerdictTest, LostFramesCount) {
  MapEvidence evidence = MakeMapEvidence();
  const int used = evidence.build.frames_used;
  evidence.build.frames = used + used / 10;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
  evidence.build.frames = used * 100 / 79;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kResurvey);
  EXPECT_FALSE(VerdictOf(evidence).Usable());
  evidence.build.frames = used * 100 / 81;
  EXPECT_TRUE(VerdictOf(evidence).Usable());
}

TEST(VerdictTest, FramesTakenAtStandstillAreNotLost) {
  MapEvidence evidence = MakeMapEvidence();
  for (int i = 0; i < evidence.build.frames_used; ++i) {
    evidence.build.dropped.push_back({"images/still.jpg", kStoodStill});
  }
  evidence.build.frames = 2 * evidence.build.frames_used;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kTrust);
}

// Gives the frames an odometry whose error grows with the way.
void AddOdometry(double share, double rad_per_m, MapEvidence* evidence) {
  double way_m = 0.0;
  const Eigen::Vector2d* before = nullptr;
  std::vector<Eigen::Vector2d> positions;
  for (const MapFrame& frame : evidence->frames) {
    positions.push_back(frame.map_from_base.translation());
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    way_m += before == nullptr ? 0.0 : (positions[i] - *before).norm();
    before = &positions[i];
    evidence->frames[i].odom_from_base = Pose2(positions[i].x(), positions[i].y() + share * way_m, rad_per_m * way_m);
  }
  evidence->build.drift_m = share * way_m;
}

TEST(VerdictTest, DriftOfWheelsIsEvidenceAndMoreIsADoubt) {
  MapEvidence evidence = MakeMapEvidence();
  AddOdometry(0.01, 0.003, &evidence);
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kTrust);
  EXPECT_THAT(VerdictOf(evidence).facts, Contains(HasSubstr("Odometry had drifted")));
  for (const auto& [share, rad_per_m] : {std::pair(0.056, 0.025), {0.0, 0.025}, {0.056, 0.0}}) {
    AddOdometry(share, rad_per_m, &evidence);
    EXPECT_EQ(VerdictOf(evidence).trust, Trust::kInspect);
    EXPECT_THAT(VerdictOf(evidence).reasons, Contains(HasSubstr("more than wheels drift")));
    EXPECT_THAT(VerdictOf(evidence).facts, Not(Contains(HasSubstr("Odometry had drifted"))));
  }
}

TEST(VerdictTest, ControlPointsThatAreMissedAreNamed) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.control_points = {{"a.jpg", {1.0, 1.0}, {1.001, 1.0}}};
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kTrust);
  evidence.build.control_points[0].observed_m.x() = 1.012;
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kInspect);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("1.2 cm RMS")));
}

TEST(VerdictTest, ControlPointsMayMissByWhatTheyAreWorth) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.control_points = {{"a.jpg", {1.0, 1.0}, {1.03, 1.0}, 0.001}};
  EXPECT_FALSE(VerdictOf(evidence).Usable());
  evidence.build.control_points[0].sigma_m = 0.02;
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kTrust);
  evidence.build.control_points[0].observed_m.x() = 1.05;
  const Verdict verdict = VerdictOf(evidence);
  EXPECT_EQ(verdict.trust, Trust::kInspect);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("--control-sigma")));
}

TEST(VerdictTest, AMapThatMissesItsControlPointsIsNotUsable) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.build.control_points = {{"a.jpg", {1.0, 1.0}, {1.75, 1.0}}};
  EXPECT_EQ(VerdictOf(evidence).trust, Trust::kResurvey);
  EXPECT_THAT(VerdictOf(evidence).reasons.front(), HasSubstr("check their coordinates"));
  evidence.build.control_point_scale = 1.04;
  EXPECT_THAT(VerdictOf(evidence).reasons.front(), HasSubstr("1.040 times as far apart"));
}

}  // namespace
}  // namespace floorloc
