// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/video_input.h"

#include <sstream>
#include <stdexcept>

#include "core/io/text_file.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// Identifies all inputs of a folder, so that an existing one is reused.
std::string SourceOf(const VideoSurveyOptions& options) {
  std::ostringstream source;
  source.precision(17);
  source << options.start_s << " " << options.step_s << "\n";
  for (const fs::path& file : {options.video, options.camera_yaml, options.floor_yaml, options.odometry}) {
    std::error_code error;
    if (fs::is_regular_file(file, error)) {
      source << fs::absolute(file).lexically_normal().string() << " " << fs::file_size(file, error) << " "
             << fs::last_write_time(file, error).time_since_epoch().count() << "\n";
    }
  }
  return source.str();
}

bool IsMadeFrom(const fs::path& folder, const std::string& source) {
  std::error_code error;
  return fs::is_regular_file(folder / "source.txt", error) && ReadTextFile(folder / "source.txt") == source;
}

}  // namespace

void AddVideoOptions(CLI::App* command, VideoArguments* a) {
  auto* camera = command->add_option("--camera", a->camera_yaml, "Of the videos and bags (camera.yaml)");
  auto* floor = command->add_option("--floor", a->floor_yaml, "Of the videos and bags (floor.yaml)");
  auto* video = command->add_option("--video", a->videos, "Video(s) of the floor instead of survey folders");
  video->needs(camera)->needs(floor);
  command->add_option("--odometry", a->odometry, "odom_from_base during the videos (TUM)")->needs(video);
  command->add_option("--video-start", a->start_s,
                      "Time of each video's first image, seconds on the odometry's clock (default: 0)");
  command->add_option("--video-step", a->step_s, "Seconds between the images taken from a video, the sharpest each")
      ->capture_default_str();
  command->add_flag("--keep-frames", a->keep_frames, "Keep the images taken from videos (MAP.video)");
}

VideoInput::VideoInput(const VideoArguments& arguments, const fs::path& map, const ProgressOutput& progress,
                       std::vector<fs::path>* surveys)
    : arguments_(arguments), folder_(map.string() + ".video"), progress_(progress) {
  for (fs::path& survey : *surveys) {
    if (const fs::path video = FindVideo(survey); !video.empty()) {
      const fs::path odometry = survey / "odometry.tum";
      VideoSurveyOptions options;
      options.video = video;
      options.camera_yaml = survey / "camera.yaml";
      options.floor_yaml = survey / "floor.yaml";
      options.odometry = fs::exists(odometry) ? odometry : fs::path();
      survey = Convert(std::move(options));
    }
  }
  for (const fs::path& video : arguments.videos) {
    VideoSurveyOptions options;
    options.video = video;
    options.camera_yaml = arguments.camera_yaml;
    options.floor_yaml = arguments.floor_yaml;
    options.odometry = arguments.odometry;
    surveys->push_back(Convert(std::move(options)));
  }
  if (surveys->empty()) {
    throw std::invalid_argument(
        "nothing to build from: name survey folders with --survey, bags with --bag, or videos with --video");
  }
  if (arguments.start_s.size() > count_) {
    throw std::invalid_argument("there are more --video-start than videos; give one for each video, in their order");
  }
}

fs::path VideoInput::Convert(VideoSurveyOptions options) {
  if (!arguments_.start_s.empty()) {
    if (count_ >= arguments_.start_s.size()) {
      throw std::invalid_argument("there are fewer --video-start than videos; give one for each video, in their order");
    }
    options.start_s = arguments_.start_s[count_];
  }
  options.out = folder_ / (std::to_string(count_) + "-" + options.video.stem().string());
  options.step_s = arguments_.step_s;
  options.run.progress = progress_;
  ++count_;
  const std::string source = SourceOf(options);
  if (!IsMadeFrom(options.out, source)) {
    const VideoSurveyResult result = WriteVideoSurvey(options);
    warnings_.insert(warnings_.end(), result.warnings.begin(), result.warnings.end());
    WriteFileAtomically(options.out / "source.txt", source);
  }
  return options.out;
}

void VideoInput::Finish() const {
  if (count_ > 0 && !arguments_.keep_frames) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
}

}  // namespace floorloc
