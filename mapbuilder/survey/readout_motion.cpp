// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/readout_motion.h"

#include "core/io/trajectory_twist.h"
#include "core/odometry/planar_odometry.h"

namespace floorloc {
namespace {

// Images that are farther apart do not tell the velocity at their times; those of a folder without stamps are 1 s
// apart.
constexpr double kMaxStepS = 0.7;

// Sum and number of the velocities that are known on both sides of a frame.
struct MeanTwist {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;

  void Add(const Eigen::Vector3d& twist) {
    sum += twist;
    ++count;
  }
};

}  // namespace

Eigen::Vector3d ReadoutMotionByOdometry(const Survey& survey, const SurveyFrame& frame) {
  const Readout& readout = survey.camera.camera.readout;
  return readout.seconds ? MotionOfReadout(readout, TwistAt(survey.odometry, frame.stamp_ns)).motion
                         : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

bool NeedsMotionByImages(const Survey& survey) {
  return survey.odometry.empty() && survey.camera.camera.readout.seconds.value_or(0.0) > 0.0;
}

std::vector<int> SetReadoutMotionByImages(const LoadedSurvey& loaded, int survey, std::vector<BuildFrame>* frames) {
  PlanarOdometryOptions options;
  options.resolution_m = loaded.survey.camera.floor.resolution_m;
  PlanarOdometry odometry(options);
  std::vector<MeanTwist> twists(frames->size());
  std::size_t before = 0;
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const BuildFrame& frame = (*frames)[i];
    if (frame.survey != survey || !frame.unreadable.empty()) {
      continue;
    }
    const auto motion = odometry.Track(frame.info.stamp_ns, frame.features).motion;
    const double step_s = motion ? ToSeconds(motion->to_ns - motion->from_ns) : 0.0;
    if (motion && step_s <= kMaxStepS) {
      const Eigen::Vector3d twist = motion->from_from_to.Log() / step_s;
      twists[i].Add(twist);
      twists[before].Add(twist);
    }
    before = i;
  }
  std::vector<int> moved;
  for (std::size_t i = 0; i < twists.size(); ++i) {
    if (twists[i].count > 0) {
      const Eigen::Vector3d twist = twists[i].sum / twists[i].count;
      (*frames)[i].readout_motion = MotionOfReadout(loaded.survey.camera.camera.readout, twist).motion;
      moved.push_back(static_cast<int>(i));
    }
  }
  return moved;
}

}  // namespace floorloc
