// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/survey/video_survey.h"

namespace floorloc {

/// Videos on the command line of build.
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

/// The survey folders that videos are turned into, beside the map: MAP.video. They outlive a failed build, whose
/// journal refers to them, and disappear with Finish().
class VideoInput {
 public:
  /// Replaces folders in `surveys` that hold a video by those made from it, and adds those of the videos. Throws
  /// InputError or std::invalid_argument.
  VideoInput(const VideoArguments& arguments, const std::filesystem::path& map, const ProgressOutput& progress,
             std::vector<std::filesystem::path>* surveys);

  const std::vector<std::string>& warnings() const { return warnings_; }
  /// The map is there: removes the folders unless they are to be kept.
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
