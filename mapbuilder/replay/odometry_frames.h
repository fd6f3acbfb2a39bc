// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/survey.h"
#include "core/odometry/monocular_odometry.h"
#include "core/odometry/planar_odometry.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/run_options.h"

namespace floorloc {

struct PlanarFramesOptions {
  ExtractorOptions extractor;
  PlanarOdometryOptions odometry;  ///< with the survey's resolution
  bool use_wheels = false;         ///< search each frame around the prediction of odometry.tum
  RunOptions run{.threads = 1};    ///< for feature extraction

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Result for one frame of a camera above the floor.
struct PlanarFrame {
  SurveyFrame frame;
  PlanarOdometryResult result;
  Pose2 odom_from_base;  ///< in the frame of the folder's odometry if it has one
  int keypoints = 0;
  double decode_ms = 0.0;
  double features_ms = 0.0;  ///< including rectification
  double track_ms = 0.0;
};

/// Planar visual odometry over the frames of a folder. The first frame's pose is that of odometry.tum at its stamp,
/// else the identity. Deterministic for any number of threads. Throws InputError.
std::vector<PlanarFrame> TrackPlanarFrames(const Survey& survey, const PlanarFramesOptions& options);

/// Frames whose motion is known.
Trajectory ToTrajectory(const std::vector<PlanarFrame>& frames);

/// One line of the --results file.
std::string ToJsonLine(const PlanarFrame& frame);

struct MonocularFramesOptions {
  MonocularOdometryOptions odometry;
  Trajectory positions;  ///< of the camera, in any fixed frame, to determine the scale; may be empty
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Result for one frame of a camera in any orientation.
struct MonocularFrame {
  SurveyFrame frame;
  MonocularOdometryResult result;
  double decode_ms = 0.0;
  double track_ms = 0.0;
};

/// Monocular odometry over the frames of a recording, in the camera frame of the first. Throws InputError.
std::vector<MonocularFrame> TrackMonocularFrames(const CameraRecording& recording,
                                                 const MonocularFramesOptions& options);

/// Frames that were not lost.
Trajectory ToTrajectory(const std::vector<MonocularFrame>& frames);

/// One line of the --results file.
std::string ToJsonLine(const MonocularFrame& frame);

}  // namespace floorloc
