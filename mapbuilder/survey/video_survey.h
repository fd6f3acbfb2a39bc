// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"

namespace floorloc {

/// A survey recorded as a video instead of single images.
struct VideoSurveyOptions {
  std::filesystem::path video;        ///< any format that OpenCV reads
  std::filesystem::path camera_yaml;  ///< of the camera that recorded it
  std::filesystem::path floor_yaml;
  std::filesystem::path odometry;  ///< TUM; empty: none
  std::filesystem::path out;       ///< survey folder to write; an existing one is replaced
  double start_s = 0.0;            ///< time of the first image on the clock of the odometry
  double step_s = 0.2;             ///< one image is used per time step
  RunOptions run;

  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

struct VideoSurveyResult {
  int frames_read = 0;
  int frames_written = 0;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Converts a video to a survey folder: the sharpest image of each time step, without those that show the same as their
/// predecessor. The folder appears only when complete. Throws InputError when the video is unreadable, empty or of
/// another size than in camera.yaml, or the folder is not writable.
VideoSurveyResult WriteVideoSurvey(const VideoSurveyOptions& options);

/// The video in a folder that has one next to camera.yaml and floor.yaml instead of frames.csv and images; empty for
/// any other folder.
std::filesystem::path FindVideo(const std::filesystem::path& folder);

}  // namespace floorloc
