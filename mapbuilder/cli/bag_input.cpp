// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/bag_input.h"

#include <algorithm>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "core/io/text_file.h"
#include "mapbuilder/bag/open_bag.h"
#include "mapbuilder/unpack/unpack_bag.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// Identifies all inputs of a folder, so that an existing one is used again.
std::string SourceOf(const fs::path& bag, const SurveyChoice& choice) {
  std::ostringstream source;
  for (const std::string& text : {choice.image_topic, choice.camera_info_topic, choice.odom_topic, choice.imu_topic,
                                  choice.truth_topic, choice.odom_frame, choice.base_frame}) {
    source << text << "\n";
  }
  source.precision(17);
  source << choice.base_height_m.value_or(-1.0) << " " << choice.needs_floor << "\n";
  std::vector<fs::path> files = BagFiles(bag);
  files.push_back(choice.camera_yaml);
  files.push_back(choice.floor_yaml);
  for (const fs::path& file : files) {
    std::error_code error;
    if (fs::is_regular_file(file, error)) {
      source << fs::absolute(file).lexically_normal().string() << " " << fs::file_size(file, error) << " "
             << fs::last_write_time(file, error).time_since_epoch().count() << "\n";
    }
  }
  return source.str();
}

}  // namespace

void AddTopicOptions(CLI::App* command, CLI::Option* needed, SurveyChoice* choice) {
  const auto add = [&](const char* name, std::string& value, const char* what) {
    CLI::Option* option = command->add_option(name, value, what);
    if (needed != nullptr) {
      option->needs(needed);
    }
  };
  add("--image-topic", choice->image_topic, "Images of the bag (default: the only topic of them)");
  add("--camera-info-topic", choice->camera_info_topic, "Their calibration (default: camera_info beside them)");
  add("--odom-topic", choice->odom_topic, "Odometry, or poses of another system; none: leave it out");
  add("--odom-frame", choice->odom_frame, "Odometry is the transform from this frame to the base in /tf");
  add("--base-frame", choice->base_frame,
      "The robot's frame (default: the odometry's child, base_footprint or base_link)");
  add("--imu-topic", choice->imu_topic, "IMU; none: leave it out");
  add("--truth-topic", choice->truth_topic, "Poses in the map, for evaluation only");
  CLI::Option* height =
      command->add_option("--base-height", choice->base_height_m,
                          "Height of the base frame over the floor, metres (default: by base_footprint)");
  if (needed != nullptr) {
    height->needs(needed);
  }
}

void AddCalibrationOptions(CLI::App* command, CLI::Option* needed, SurveyChoice* choice) {
  for (CLI::Option* option :
       {command->add_option("--camera", choice->camera_yaml, "camera.yaml, instead of the bag's CameraInfo"),
        command->add_option("--floor", choice->floor_yaml, "floor.yaml, instead of the bag's /tf_static")}) {
    if (needed != nullptr) {
      option->needs(needed);
    }
  }
}

BagInput::BagInput(const BagArguments& arguments, const fs::path& output, const ProgressOutput& progress,
                   Lifetime lifetime)
    : arguments_(arguments), root_(output.string() + ".bag"), progress_(progress), lifetime_(lifetime) {
  try {
    for (const fs::path& bag : arguments_.bags) {
      folders_.push_back(Unpack(bag));
    }
  } catch (...) {
    std::error_code ignored;
    fs::remove(root_, ignored);  // when empty
    throw;
  }
}

BagInput::~BagInput() {
  if (lifetime_ == Lifetime::kTemporary) {
    Finish();
  }
}

void BagInput::Finish() const {
  if (!arguments_.bags.empty()) {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }
}

fs::path BagInput::Unpack(const fs::path& bag) {
  fs::path folder = root_ / BagName(bag);
  if (std::find(folders_.begin(), folders_.end(), folder) != folders_.end()) {
    throw std::invalid_argument("two bags have the name " + BagName(bag) +
                                "; rename one, so that the map can tell them apart");
  }
  const fs::path source_file = folder.string() + ".source";
  const std::string source = SourceOf(bag, arguments_.choice);
  std::error_code error;
  if (fs::is_regular_file(source_file, error) && ReadTextFile(source_file) == source && fs::exists(folder)) {
    return folder;
  }
  RunOptions run;
  run.progress = progress_;
  const BagSummary summary = SummarizeBag(bag);
  const SurveyPlan plan = PlanSurvey(summary, arguments_.choice);
  fs::remove_all(folder, error);
  const UnpackedBag unpacked = UnpackBag(summary, plan, folder, run);
  WriteFileAtomically(source_file, source);
  for (const std::string& warning : unpacked.warnings) {
    warnings_.push_back(bag.filename().string() + ": " + warning);
  }
  for (const std::string& note : unpacked.notes) {
    notes_.push_back(bag.filename().string() + ": " + note);
  }
  return folder;
}

void AddDriveOptions(CLI::App* command, fs::path* frames, BagArguments* bag) {
  CLI::Option_group* group = command->add_option_group("frames");
  group->add_option("--frames", *frames, "Folder in the survey format");
  CLI::Option* option = group->add_option("--bag", bag->bags, "Bag of ROS: .mcap, .db3 or .bag file, or their folder");
  option->expected(1);
  group->require_option(1);
  AddCalibrationOptions(command, option, &bag->choice);
  AddTopicOptions(command, option, &bag->choice);
}

fs::path FolderOf(const fs::path& frames, const BagInput& bag) {
  return bag.folders().empty() ? frames : bag.folders().front();
}

void PrintWarnings(const BagInput& bag) {
  for (const std::string& warning : bag.warnings()) {
    std::cerr << "floorloc-mapbuilder: " << warning << "\n";
  }
}

}  // namespace floorloc
