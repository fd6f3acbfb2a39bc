// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "core/io/delimited_text.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/cli/simulate_arguments.h"
#include "mapbuilder/cli/simulate_fleet.h"
#include "mapbuilder/simulation/procedural_floor.h"

namespace floorloc {
namespace {

void ChooseSize(const std::string& text, FloorTextureOptions& floor) {
  const auto size = ParseSize(text);
  if (!size) {
    throw std::invalid_argument("--size '" + text + "' is not WIDTHxHEIGHT in metres, such as 2.6x1.8");
  }
  floor.width_m = (*size)[0];
  floor.height_m = (*size)[1];
}

// Defaults for a drive: the sensors and rates that robots usually record.
void ChooseSensors(const SimulateArguments& arguments, PathOptions& path) {
  const bool drive = path.type == PathType::kDrive;
  if (!drive && (!path.drive.kidnaps_s.empty() || path.drive.stops > 0 || path.drive.slips > 0 || arguments.imu_rate ||
                 arguments.speed_variation)) {
    throw std::invalid_argument("--kidnap, --stops, --slips, --imu-rate and --speed-variation need --trajectory drive");
  }
  path.odometry_rate_hz = arguments.odometry_rate.value_or(drive ? 50.0 : 0.0);
  path.imu_rate_hz = arguments.imu_rate.value_or(drive ? 100.0 : 0.0);
  path.imu = path.imu.Scaled(arguments.imu_errors);
  path.drive.speed_variation = arguments.speed_variation.value_or(drive ? 0.3 : 0.0);
}

void PrintSummary(const SimulateOptions& options, const SimulationResult& result) {
  std::cout << options.out.string() << ": " << result.frames << " frames along " << result.path_length_m
            << " m; odometry is off by " << result.odometry_drift_m << " m at the end; " << 100.0 * result.wear_share
            << " % of the floor changed (floor " << result.floor_s << " s, frames " << result.render_s << " s)\n";
}

void PrintJson(const SimulateOptions& options, const SimulationResult& result) {
  const nlohmann::json json = {{"out", options.out.string()},
                               {"frames", result.frames},
                               {"path_length_m", result.path_length_m},
                               {"odometry_drift_m", result.odometry_drift_m},
                               {"odometry_drift_rad", result.odometry_drift_rad},
                               {"wear_share", result.wear_share},
                               {"floor_s", result.floor_s},
                               {"render_s", result.render_s}};
  std::cout << json.dump(2) << "\n";
}

// A fleet has the map's camera unless one is given.
void RunFleetOf(SimulateArguments& arguments, const CLI::App& command) {
  FleetOptions& fleet = arguments.fleet;
  if (command.count("--camera") + command.count("--camera-height") + command.count("--camera-yaml") > 0) {
    fleet.camera = ChooseCamera(arguments);
  }
  fleet.calibration_error = ChooseCalibrationError(arguments);
  fleet.conditions = ChooseConditions(arguments);
  fleet.odometry = fleet.odometry.Scaled(arguments.odometry_drift);
  fleet.imu = fleet.imu.Scaled(arguments.imu_errors);
  fleet.drive.speed_m_s = arguments.options.path.speed_m_per_s;
  fleet.threads = arguments.options.run.threads;
  fleet.seed = fleet.schedule.seed = arguments.options.seed;
  RunFleetCommand(fleet, arguments.json);
}

void Run(SimulateArguments& arguments, const CLI::App& command) {
  if (command.count("--fleet") > 0) {
    RunFleetOf(arguments, command);
    return;
  }
  for (const char* needed : {"--out", "--texture"}) {
    if (command.count(needed) == 0) {
      throw CLI::RequiredError(needed);
    }
  }
  SimulateOptions& options = arguments.options;
  ChooseSize(arguments.size, options.floor);
  options.floor.rotate_patches = !arguments.keep_direction;
  options.floor.run = options.run;
  options.camera = ChooseCamera(arguments);
  options.calibration_error = ChooseCalibrationError(arguments);
  options.conditions = ChooseConditions(arguments);
  options.path.type = ParsePathType(arguments.trajectory);
  options.path.odometry = options.path.odometry.Scaled(arguments.odometry_drift);
  ChooseSensors(arguments, options.path);
  options.write_odometry = !arguments.no_odometry;
  options.run.progress = ProgressOutput::Stderr();
  const SimulationResult result = Simulate(options);
  arguments.json ? PrintJson(options, result) : PrintSummary(options, result);
}

void AddFloorOptions(CLI::App& command, SimulateArguments& a) {
  command.add_option("--texture", a.options.floor.source,
                     "Photograph of a floor that tiles seamlessly, or one of " + JoinedFloorNames() + "; required");
  command.add_option("--size", a.size, "Floor, WIDTHxHEIGHT in metres")->capture_default_str();
  CLI::Option* stripes = command.add_option("--stripes", a.options.floor.stripes,
                                            "Another texture, in stripes that alternate with the first along x");
  command.add_option("--stripe-width", a.options.floor.stripe_m, "Width of the stripes and of the gaps, metres")
      ->needs(stripes)
      ->capture_default_str();
  command.add_option("--texture-width", a.options.floor.image_width_m, "Width of the photographed piece, metres")
      ->capture_default_str();
  command.add_flag("--keep-direction", a.keep_direction, "Don't rotate pieces of the photograph (wood, bricks)");
  command.add_option("--resolution", a.options.floor.resolution_m, "Metres per pixel of the floor's image")
      ->capture_default_str();
  command.add_option("--floor-seed", a.options.floor.seed, "Another number, another floor")->capture_default_str();
  command.add_option("--wear", a.options.wear, "Share of the floor that has changed, 0 to 0.9")->capture_default_str();
}

void AddPathOptions(CLI::App& command, SimulateArguments& a) {
  command.add_option("--trajectory", a.trajectory, "What the robot does")
      ->check(CLI::IsMember({"survey", "drive", "random"}))
      ->capture_default_str();
  command.add_option("--frames", a.options.path.frames, "Number of frames of a drive or of random poses")
      ->capture_default_str();
  command.add_option("--overlap", a.options.path.overlap, "Of neighbouring images of a survey")->capture_default_str();
  command.add_option("--speed", a.options.path.speed_m_per_s, "Metres per second")->capture_default_str();
  command.add_option("--fps", a.options.path.fps, "Frames per second of a drive")->capture_default_str();
  command.add_option("--odometry-drift", a.odometry_drift, "Factor on the odometry's errors; 0: perfect odometry")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command.add_flag("--no-odometry", a.no_odometry, "Leave odometry.tum out");
}

void AddDriveOptions(CLI::App& command, SimulateArguments& a) {
  DriveOptions& drive = a.options.path.drive;
  command.add_option(
      "--odometry-rate", a.odometry_rate,
      "Odometry per second, with the truth in groundtruth_dense.tum; 0: at the frames (drive: 50, else 0)");
  command.add_option("--imu-rate", a.imu_rate, "IMU samples per second of a drive; 0: no imu.csv (100)");
  command.add_option("--imu-errors", a.imu_errors, "Factor on the IMU's errors; 0: perfect IMU")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command.add_option("--speed-variation", a.speed_variation, "Share by which a drive's speed rises and falls (0.3)");
  command.add_option("--stops", drive.stops, "Times a drive stands still for a while")->capture_default_str();
  command.add_option("--slips", drive.slips, "Times the wheels of a drive turn without grip")->capture_default_str();
  command
      .add_option("--kidnap", drive.kidnaps_s,
                  "Times, S,S,...: the robot is lifted and put down elsewhere, unnoticed by its wheels")
      ->delimiter(',');
}

void AddImageOptions(CLI::App& command, SimulateArguments& a) {
  command.add_option("--camera", a.camera, "Built-in camera")
      ->check(CLI::IsMember({"down", "forward", "equidistant"}))
      ->capture_default_str();
  auto* height = command
                     .add_option("--camera-height", a.camera_height_m,
                                 "Of the built-in camera over the floor, metres, instead of down 0.4, forward 0.35, "
                                 "equidistant 0.3")
                     ->check(CLI::Range(0.05, 10.0));
  auto* camera_yaml = command.add_option("--camera-yaml", a.camera_yaml, "Camera from a file, with --floor-yaml");
  auto* floor_yaml = command.add_option("--floor-yaml", a.floor_yaml, "Its place over the floor, with --camera-yaml");
  camera_yaml->needs(floor_yaml);
  floor_yaml->needs(camera_yaml);
  camera_yaml->excludes(height);
  command.add_option("--condition", a.condition, "Light, blur, noise, vibration")
      ->check(CLI::IsMember({"clean", "mild", "hard"}))
      ->capture_default_str();
  command.add_option("--blur", a.blur_px, "Longest motion blur, pixels, instead of the condition's");
  command.add_option("--shadow", a.shadow, "Strength of the shadow, 0 to 1, instead of the condition's");
  command.add_option("--lamps", a.lamps, "Strength of the lamps, 0 to 10, instead of the condition's");
  command.add_option("--noise", a.noise, "Sensor noise, grey values, instead of the condition's");
  command.add_option("--rolling-shutter", a.rolling_shutter_s,
                     "Seconds in which the rows are exposed one after the other (0); 0: global shutter");
  command.add_option("--height-variation", a.height_variation,
                     "Share by which single images are taken higher or lower, 0 to 0.5 (0)");
  command.add_option("--jpeg-quality", a.jpeg_quality, "1 to 100, instead of the condition's");
}

void AddOverlayOptions(CLI::App& command, SimulateArguments& a) {
  OverlayOptions& overlay = a.options.conditions.overlay;
  auto* kind = command
                   .add_option("--overlay", a.overlay,
                               "What stands still in every image: a textured part of the robot, the camera's time "
                               "stamp,\na sticker, dirt on the glass, or the pattern of a lamp on the camera")
                   ->check(CLI::IsMember(OverlayKindNames()));
  command.add_option("--overlay-share", a.overlay_share, "Share of the image that it covers, 0 to 0.9")
      ->needs(kind)
      ->capture_default_str();
  command.add_option("--overlay-sway", overlay.sway_px, "Standard deviation of its place, pixels, as a cable's")
      ->needs(kind)
      ->capture_default_str();
  command.add_option("--overlay-seed", overlay.seed, "Another number, another look; not changed by --seed")
      ->needs(kind)
      ->capture_default_str();
}

void AddCalibrationOptions(CLI::App& command, SimulateArguments& a) {
  command.add_option(
      "--radial-error", a.radial_error,
      "What camera.yaml is wrong by: radial distortion, pixels at the farthest corner (of the camera's 0.3\n"
      "px, two thirds, unless the condition is clean)");
  command.add_option("--tangential-error", a.tangential_error,
                     "Tangential distortion, pixels at the farthest corner (one third)");
  command.add_option("--principal-point-error", a.principal_point_error, "Principal point, pixels (0)");
  command.add_option("--focal-error", a.focal_error, "Focal length, as a share of it (0)");
  command.add_option("--roll-error", a.roll_error_deg,
                     "What floor.yaml is wrong by: roll of the camera, degrees (0.1 unless the condition is clean)");
  command.add_option("--pitch-error", a.pitch_error_deg, "Pitch of the camera, degrees (-0.05)");
  command.add_option("--height-error", a.height_error, "Height of the camera, metres (0)");
  command.add_flag("--exact-calibration", a.exact_calibration, "Nothing is wrong but what other options say");
}

}  // namespace

void AddSimulateCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("simulate", "Makes a survey or a drive with exact ground truth, or drives a fleet");
  const auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("--out", arguments->options.out, "Folder to be made; required");
  AddFloorOptions(*command, *arguments);
  AddPathOptions(*command, *arguments);
  AddDriveOptions(*command, *arguments);
  AddImageOptions(*command, *arguments);
  AddOverlayOptions(*command, *arguments);
  AddCalibrationOptions(*command, *arguments);
  CLI::Option* fleet = AddFleetOptions(*command, arguments->fleet);
  for (const char* other : {"--out", "--texture", "--size", "--trajectory", "--frames", "--wear"}) {
    fleet->excludes(command->get_option(other));
  }
  command->add_option("--seed", arguments->options.seed, "Seed of everything but the floor")->capture_default_str();
  command->add_option("--threads", arguments->options.run.threads, "Number of threads; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Machine-readable summary on stdout");
  command->callback([arguments, command] { Run(*arguments, *command); });
}

}  // namespace floorloc
