// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/verdict_reasons.h"

#include "mapbuilder/report/number_text.h"

namespace floorloc {

bool AssessCameras(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons) {
  const CameraDoubt& doubt = build.camera_doubt;
  const bool severe = doubt.pose_rms_m > options.max_camera_m;
  if (doubt.pose_rms_m > options.doubtful_camera_m) {
    reasons->Add(severe,
                 "The images contradict the cameras' calibration, by how floor is seen at different headings and "
                 "in different parts of the image: calibrated by them, the cameras would see it up to " +
                     FixedText(doubt.camera_px, 1) + " px elsewhere, and poses would be " +
                     LengthText(doubt.pose_rms_m) +
                     " elsewhere (RMS); build the map again without --self-calibrate, or calibrate the camera.");
  }
  return severe;
}

bool AssessRepetition(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons) {
  const int joined = build.part_sizes.empty() ? build.frames_used : build.part_sizes.front();
  const bool severe = build.repeats_unaided && joined < options.min_frames_used * build.frames;
  if (severe) {
    reasons->Add(true, "The floor repeats itself and the survey has no odometry: images alone joined " +
                           NumberText(joined) + " of " + NumberText(build.frames) +
                           " frames, and even those may be off by a period of the floor; survey it with odometry.tum, "
                           "or build with --poses.");
  }
  return severe;
}

}  // namespace floorloc
