// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"

namespace floorloc {

/// A video of the floor instead of single images.
struct VideoSurveyOptions {
  std::filesystem::path video;        ///< whatever OpenCV can read
  std::filesystem::path camera_yaml;  ///< of the camera that took it
  std::filesystem::path floor_yaml;
  std::filesystem::path odometry;  ///< TUM; empty: none
  std::filesystem::path out;       ///< survey folder to write; replaced when it is there
  double start_s = 0.0;            ///< time of the video's first image, on the clock of the odometry
  double step_s = 0.2;             ///< one image is taken from each such span of time
  ProgressOutput progress;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

struct VideoSurveyResult {
  int frames_read = 0;
  int frames_written = 0;
  std::vector<std::string> warnings;  ///< sentences
};

/// Video -> survey folder: the sharpest image of each span of time, without those that show the same as the one
/// before. The folder appears when it is complete. Throws InputError: video unreadable, of another size than
/// camera.yaml says, or empty; folder not writable.
VideoSurveyResult WriteVideoSurvey(const VideoSurveyOptions& options);

/// The video of a folder that holds one beside camera.yaml and floor.yaml, instead of frames.csv and images; empty when
/// it is no such folder.
std::filesystem::path FindVideo(const std::filesystem::path& folder);

}  // namespace floorloc
