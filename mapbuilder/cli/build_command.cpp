// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/io/planar_trajectory.h"
#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/build/build_report.h"
#include "mapbuilder/cli/bag_input.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/cli/video_input.h"
#include "mapbuilder/fiducials/aruco_dictionary.h"
#include "mapbuilder/report/write_report.h"

namespace floorloc {
namespace {

struct Arguments {
  BuildOptions options;
  VideoArguments video;
  BagArguments bag;
  std::vector<std::string> bag_notes;
  std::string features = "auto";
  std::string poses_file;
  std::vector<std::string> self_calibrate{"auto"};
  std::string free_height = "auto";
  std::vector<double> poses_sigma;
  std::vector<std::string> distances;
  std::filesystem::path report;
  bool no_held_out = false;
  bool json = false;
};

std::vector<std::string> ExtractorNames() {
  std::vector<std::string> names{"auto"};
  for (const ExtractorType type : AllExtractorTypes()) {
    names.emplace_back(ToString(type));
  }
  return names;
}

// Size and modification time of an option that is a file.
std::string StateOfFile(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    return "";
  }
  return "," + std::to_string(std::filesystem::file_size(file, error)) + "," +
         std::to_string(std::filesystem::last_write_time(file, error).time_since_epoch().count());
}

// All options that can change the map: a journal is valid only for the options it was written with.
std::string FingerprintOf(const CLI::App& command) {
  std::string fingerprint;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (name != "--resume" && name != "--threads" && name != "--json" && name != "--keep-frames" &&
        name != "--report") {
      for (const std::string& value : option->results()) {
        fingerprint.append(name).append("=").append(value).append(StateOfFile(value)).append("\n");
      }
    }
  }
  return fingerprint;
}

BuildReport BuildWithResumeHint(const BuildOptions& options) {
  try {
    return BuildMap(options);
  } catch (const std::exception& error) {
    if (std::filesystem::exists(BuildJournal::FileFor(options.out))) {
      throw std::runtime_error(std::string(error.what()) + " (finished work is kept: continue with --resume)");
    }
    throw;
  }
}

std::string JsonWithVerdict(const BuildReport& report, const Verdict& verdict,
                            const std::vector<std::string>& bag_notes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(ToJson(report, true));
  json["verdict"] = {{"trust", ToString(verdict.trust)}, {"headline", verdict.headline}, {"reasons", verdict.reasons}};
  if (!bag_notes.empty()) {
    json["bag"] = bag_notes;
  }
  return json.dump(2);
}

void Print(const Arguments& a, const BuildReport& report, const Verdict& verdict) {
  if (a.json) {
    std::cout << JsonWithVerdict(report, verdict, a.bag_notes) << "\n";
    std::cerr << a.options.out.string() << ": " << verdict.headline << "\n";
  } else {
    std::cout << a.options.out.string() << "\n" << ToText(report);
    for (const std::string& note : a.bag_notes) {
      std::cout << "  bag          " << note << "\n";
    }
    std::cout << "  verdict      " << verdict.headline << "\n";
  }
  if (!a.report.empty()) {
    std::cerr << (a.report / "report.html").string() << ": " << verdict.headline << "\n";
  }
}

void Run(Arguments& a) {
  if (a.features != "auto") {
    a.options.extractor.type = ParseExtractorType(a.features);
  }
  ParseCameraUnknowns(a.self_calibrate, &a.options.self_calibration);
  a.options.heights.mode = ParseFreeHeight(a.free_height);
  if (!a.poses_file.empty()) {
    a.options.poses = ReadTrajectory(a.poses_file);
    CheckPlanar(a.options.poses, a.poses_file);
  }
  if (a.poses_sigma.size() == 2) {
    a.options.placement.prior_sigma_m = a.poses_sigma[0];
    a.options.placement.prior_sigma_rad = a.poses_sigma[1];
  }
  for (const std::string& distance : a.distances) {
    a.options.distances.distances.push_back(ParseMeasuredDistance(distance));
  }
  a.options.run.progress = ProgressOutput::Stderr();
  a.options.hold_out = !a.no_held_out;
  if (!a.report.empty()) {
    PrepareReportFolder(a.report);
  }
  a.bag.choice.camera_yaml = a.video.camera_yaml;
  a.bag.choice.floor_yaml = a.video.floor_yaml;
  const BagInput bag(a.bag, a.options.out, a.options.run.progress, BagInput::Lifetime::kUntilFinished);
  a.options.surveys.insert(a.options.surveys.end(), bag.folders().begin(), bag.folders().end());
  a.bag_notes = bag.notes();
  const VideoInput video(a.video, a.options.out, a.options.run.progress, &a.options.surveys);
  BuildReport report = BuildWithResumeHint(a.options);
  report.warnings.insert(report.warnings.end(), video.warnings().begin(), video.warnings().end());
  report.warnings.insert(report.warnings.end(), bag.warnings().begin(), bag.warnings().end());
  video.Finish();
  bag.Finish();
  const Verdict verdict = a.report.empty() ? AssessMapFile(a.options.out) : WriteReport(a.options.out, a.report);
  Print(a, report, verdict);
  if (!verdict.Usable()) {
    std::cerr << "floorloc-mapbuilder: " << a.options.out.string()
              << " was built, but do not use it: " << verdict.reasons.front() << "\n";
    throw CLI::RuntimeError(kBuiltButUnusable);
  }
}

// What tells the map's scale. Returns --distance.
CLI::Option* AddScaleOptions(CLI::App& command, Arguments& a) {
  command
      .add_option("--control-sigma", a.options.control_point_sigma_m,
                  "Standard deviation of control points whose file has no sigma, metres: tape measures 0.01")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--height-sigma", a.options.scale.height_sigma_m,
                  "Standard deviation of the camera's height in floor.yaml, metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--distance-sigma", a.options.distances.sigma_m,
                  "Standard deviation of measured distances, metres: tape measures 0.005")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  return command
      .add_option("--distance", a.distances,
                  "x1,y1,x2,y2,metres: what was measured between two places of the map that this build makes without\n"
                  "it; repeatable")
      ->allow_extra_args(false);
}

void AddMarkerOptions(CLI::App& command, MarkerOptions& markers) {
  auto* file = command.add_option("--markers", markers.file,
                                  "Markers on the floor with known places (CSV: id,x,y,yaw; yaw may be empty)");
  auto* size = command.add_option("--marker-size", markers.detection.size_m, "Side of their black square, metres")
                   ->check(CLI::PositiveNumber)
                   ->needs(file);
  file->needs(size);
  command.add_option("--marker-dictionary", markers.detection.dictionary, "ArUco or AprilTag dictionary of OpenCV")
      ->check(CLI::IsMember(ArucoDictionaryNames()))
      ->needs(file)
      ->capture_default_str();
  command
      .add_option("--marker-margin", markers.margin_m,
                  "Paper around the black square that is kept out of the map, metres (default: a quarter of its size)")
      ->check(CLI::NonNegativeNumber)
      ->needs(file);
}

// What is wrong or varies with the cameras. Returns --free-height.
CLI::Option* AddCameraOptions(CLI::App& command, Arguments& a) {
  command
      .add_option("--self-calibrate", a.self_calibrate,
                  "What the images correct of the surveys' calibration: auto (all that they tell), none, or a list of\n"
                  "mounting (pitch and roll), distortion and, with control points, markers, known distances or\n"
                  "--poses, height, focal")
      ->delimiter(',')
      ->check(CLI::IsMember({"auto", "none", "mounting", "height", "focal", "distortion"}));
  CLI::Option* free_height =
      command
          .add_flag("--free-height{on}", a.free_height,
                    "Each frame has its own height: handheld, mast, kite. Without it where frames differ by more\n"
                    "than 3 %; --free-height=off: one height for all")
          ->check(CLI::IsMember({"auto", "on", "off"}));
  command
      .add_option("--mask", a.options.mask,
                  "Image of the cameras' size, black where they see no floor (the robot's own body), instead of the\n"
                  "surveys' mask.png and of what is found by itself")
      ->check(CLI::ExistingFile);
  command.add_flag("!--no-auto-mask", a.options.auto_mask.apply,
                   "Report what moves with the camera, but don't mask it");
  return free_height;
}

}  // namespace

void AddBuildCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("build", "Builds a map from survey folders, bags or videos");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--survey", a->options.surveys, "Survey folder(s)");
  CLI::Option* bag = command->add_option(
      "--bag", a->bag.bags, "Bag(s) of ROS instead of survey folders: .mcap, .db3 or .bag file, or their folder");
  AddTopicOptions(command, bag, &a->bag.choice);
  AddVideoOptions(command, &a->video);
  command->add_option("--out", a->options.out, "Map file to write (NAME.floormap)")->required();
  command
      ->add_option("--features", a->features,
                   "Feature extractor; auto: hessian. docs/benchmarks/extractors.md compares them, and\n"
                   "'./run bench extractors' does so on your floor")
      ->check(CLI::IsMember(ExtractorNames()))
      ->capture_default_str();
  command
      ->add_option("--max-keypoints", a->options.max_keypoints,
                   "Keypoints per image; 0: 700 for 640x480, more for larger images")
      ->capture_default_str();
  command->add_option("--poses", a->poses_file, "map_from_base poses of another system (TUM), taken as priors");
  command->add_option("--poses-sigma", a->poses_sigma, "Their standard deviation: metres,radians")
      ->delimiter(',')
      ->expected(2)
      ->needs("--poses");
  CLI::Option* free_height = AddCameraOptions(*command, *a);
  CLI::Option* distance = AddScaleOptions(*command, *a);
  AddMarkerOptions(*command, a->options.markers);
  command->add_flag("--keep-all", a->options.placement.keep_all, "Keep parts of the survey that do not connect");
  command->add_option("--keypoints-per-m2", a->options.max_keypoints_per_m2,
                      "Budget of the map (default: suits the camera)");
  command->add_option("--resolution", a->options.mosaic.resolution_m,
                      "Metres per pixel of the mosaic (default: survey's)");
  command->add_option("--report", a->report, "Folder for report.html and report.json on the quality of this map");
  command->add_flag("--no-held-out", a->no_held_out, "Don't test whether held-out frames are localized");
  command->add_option("--threads", a->options.run.threads, "Number of threads; 0: one per core")->capture_default_str();
  command->add_option("--seed", a->options.seed, "Seed of all random choices")->capture_default_str();
  command
      ->add_option("--extend", a->options.extend,
                   "Map file to which the surveys are added, in its frame and with its features; --out may be the same")
      ->excludes("--features")
      ->excludes("--max-keypoints")
      ->excludes("--resolution")
      ->excludes("--poses")
      ->excludes("--self-calibrate")
      ->excludes(free_height)
      ->excludes(distance);
  command->add_flag("--resume", a->options.resume, "Resume a killed build of this map");
  command->add_flag("--json", a->json, "Print the report as JSON");
  command->callback([a, command] {
    a->options.fingerprint = FingerprintOf(*command);
    Run(*a);
  });
}

}  // namespace floorloc
