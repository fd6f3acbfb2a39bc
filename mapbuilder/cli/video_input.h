// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/survey/video_survey.h"

namespace floorloc {

/// Command line arguments of build for videos.
struct VideoArguments {
  std::vector<std::filesystem::path> videos;
  std::filesystem::path camera_yaml;
  std::filesystem::path floor_yaml;
  std::filesystem::path odometry;
  std::vector<double> start_s;  ///< of each video; empty: 0
  double step_s = VideoSurveyOptions{}.step_s;
  bool keep_frames = false;
};

void AddVideoOptions(CLI::App* command, VideoArguments* arguments);

/// Converts videos to survey folders beside the map, in MAP.video. They survive a failed build, whose journal refers to
/// them, and are removed by Finish().
class VideoInput {
 public:
  /// Replaces folders in `surveys` that contain a video by the converted ones, and adds those of the videos. Throws
  /// InputError or std::invalid_argument.
  VideoInput(const VideoArguments& arguments, const std::filesystem::path& map, const ProgressOutput& progress,
             std::vector<std::filesystem::path>* surveys);

  const std::vector<std::string>& warnings() const { return warnings_; }
  /// To be called when the map is written: removes the folders unless keep_frames.
  void Finish() const;

 private:
  std::filesystem::path Convert(VideoSurveyOptions options);

  VideoArguments arguments_;
  std::filesystem::path folder_;
  ProgressOutput progress_;
  std::size_t count_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace floorloc
