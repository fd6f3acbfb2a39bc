// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/survey.h"
#include "core/odometry/monocular_odometry.h"
#include "core/odometry/planar_odometry.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/progress.h"

namespace floorloc {

struct PlanarFramesOptions {
  ExtractorOptions extractor;
  PlanarOdometryOptions odometry;  ///< the resolution is the survey's
  bool use_wheels = false;         ///< each frame is searched around the prediction of odometry.tum
  int threads = 1;                 ///< for the features; 0: one per core
  ProgressOutput progress;
};

/// One frame of a camera over the floor.
struct PlanarFrame {
  SurveyFrame frame;
  PlanarOdometryResult result;
  Pose2 odom_from_base;  ///< in the frame of the folder's odometry, where it has one
  int keypoints = 0;
  double decode_ms = 0.0;
  double features_ms = 0.0;  ///< with rectification
  double track_ms = 0.0;
};

/// Measures the motion from frame to frame of a folder. The first frame's pose is that of odometry.tum at its time,
/// else the identity. Deterministic for any number of threads. Throws InputError.
std::vector<PlanarFrame> TrackPlanarFrames(const Survey& survey, const PlanarFramesOptions& options);

/// The frames whose motion is known.
Trajectory ToTrajectory(const std::vector<PlanarFrame>& frames);

/// One line of the --results file.
std::string ToJsonLine(const PlanarFrame& frame);

struct MonocularFramesOptions {
  MonocularOdometryOptions odometry;
  Trajectory positions;  ///< of the camera, in any fixed frame: they give the scale; may be empty
  ProgressOutput progress;
};

/// One frame of a camera in any orientation.
struct MonocularFrame {
  SurveyFrame frame;
  MonocularOdometryResult result;
  double decode_ms = 0.0;
  double track_ms = 0.0;
};

/// The camera's way, frame after frame, in the first frame's camera axes. Throws InputError.
std::vector<MonocularFrame> TrackMonocularFrames(const CameraRecording& recording,
                                                 const MonocularFramesOptions& options);

/// The frames that were not lost.
Trajectory ToTrajectory(const std::vector<MonocularFrame>& frames);

/// One line of the --results file.
std::string ToJsonLine(const MonocularFrame& frame);

}  // namespace floorloc
