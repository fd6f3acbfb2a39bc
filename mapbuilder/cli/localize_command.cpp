// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>

#include "core/io/camera_mask.h"
#include "core/io/jpeg_quality.h"
#include "core/io/text_file.h"
#include "core/map/camera_correction.h"
#include "core/map/camera_mask_table.h"
#include "core/map/map_database.h"
#include "mapbuilder/cli/bag_input.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/replay/fuse_frames.h"
#include "mapbuilder/replay/localize_frames.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map, frames, out, results;
  BagArguments bag;
  std::string prior = "none";
  std::string matcher = "auto";
  double max_p_wrong = RegistrationOptions().max_p_wrong;
  std::uint32_t seed = 1;
  LocalizeFramesOptions options;
  bool fuse = false;
  std::string fusion_method = "ekf";
  bool no_imu = false;
  bool prior_given = false;
  FuseFramesOptions fusion;
};

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void PrintSummary(const std::vector<LocalizedFrame>& frames) {
  const auto with_status = [&](LocalizationStatus status) {
    return std::count_if(frames.begin(), frames.end(),
                         [&](const LocalizedFrame& f) { return f.result.status == status; });
  };
  std::vector<double> ms;
  for (const LocalizedFrame& f : frames) {
    ms.push_back(f.decode_ms + f.result.timing.total_ms);
  }
  std::printf("%zu frames: %td localized, %td ambiguous, %td not localized; median %.1f ms per frame\n", frames.size(),
              with_status(LocalizationStatus::kLocalized), with_status(LocalizationStatus::kAmbiguous),
              with_status(LocalizationStatus::kNotLocalized), Median(ms));
}

// Says that compression may be why frames are lost.
void PrintCompression(const std::vector<LocalizedFrame>& frames) {
  std::vector<double> qualities;
  for (const LocalizedFrame& f : frames) {
    if (f.result.poor_jpeg_quality && f.result.status == LocalizationStatus::kNotLocalized) {
      qualities.push_back(*f.result.poor_jpeg_quality);
    }
  }
  if (!qualities.empty()) {
    std::printf("%zu of the images not localized: %s\n", qualities.size(),
                CompressedTooMuch(static_cast<int>(Median(qualities))).c_str());
  }
}

// Says how the map corrected the camera; nothing when it did not move anything that one could see.
void PrintCorrection(const MapInfo& info, const Survey& survey) {
  constexpr double kVisiblePx = 0.05;
  const std::optional<CameraCorrection> correction =
      CorrectCamera(info, survey.camera.AtResolution(info.camera().floor.resolution_m));
  if (correction && correction->moved_px >= kVisiblePx) {
    std::printf("camera corrected as survey %d of %zu of the map corrected it: floor points move by up to %.1f px\n",
                correction->survey + 1, info.cameras.size(), correction->moved_px);
  }
}

// Says how the camera differs from its calibration; nothing when fixes can't tell a difference.
void PrintCameraEstimate(const FusedDrive& drive) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const CameraErrors& errors = drive.camera.errors.mean;
  if (drive.camera.status != CameraStatus::kCorrected && drive.camera.status != CameraStatus::kImplausible) {
    return;
  }
  std::printf(
      "camera off its calibration by %.1f px: roll %+.2f, pitch %+.2f degrees, height %+.1f %%, by %d fixes; %s\n",
      drive.camera_off_px, kDegrees * errors(0), kDegrees * errors(1), 100.0 * errors(2), drive.camera.fixes,
      drive.camera.status == CameraStatus::kCorrected ? "corrected"
                                                      : "too much to be corrected: calibrate or mount it anew");
}

// Says that the map's mask of this camera is used, where the folder has none.
void PrintMask(const MapInfo& info, const Survey& survey) {
  const cv::Mat mask = survey.mask.empty() ? MaskOfCamera(info, survey.camera) : cv::Mat();
  if (!mask.empty()) {
    std::printf("masked %.1f %% of the images, as the map has it of this camera; mask.png in the folder overrules\n",
                100.0 * MaskedShare(mask));
  }
}

// Says what of the view travels with the camera; nothing when nothing does.
void PrintLearnedMask(const FusedDrive& drive) {
  if (drive.mask.share > 0.0) {
    std::printf("%.1f %% of the view travels with the camera, by %d pairs of frames: %s\n", 100.0 * drive.mask.share,
                drive.mask.pairs,
                drive.mask.status == LearnedMaskStatus::kTooMuch
                    ? "too much to be left out; mount the camera with a free view, or paint mask.png"
                : drive.mask.left_out.empty() ? "not left out, as --no-learned-mask has it"
                                              : "left out");
  }
}

// Prints the numbers of states, rejections and relocalizations.
void PrintFusionSummary(const FusedDrive& drive) {
  std::map<std::string, int> states, rejections;
  int reanchored = 0;
  for (const FusedFrame& frame : drive.frames) {
    ++states[frame.pose ? ToString(frame.pose->state) : "before the first fix"];
    if (frame.outcome.fix && !frame.outcome.fix->accepted) {
      ++rejections[ToString(frame.outcome.fix->reason)];
    }
    reanchored += frame.outcome.fix && frame.outcome.fix->reanchored ? 1 : 0;
  }
  std::printf("fused:");
  for (const auto& [state, count] : states) {
    std::printf(" %d %s,", count, state.c_str());
  }
  std::printf(" relocalized elsewhere %d times\n", reanchored);
  for (const auto& [reason, count] : rejections) {
    std::printf("       %d fixes rejected: %s\n", count, reason.c_str());
  }
  PrintCameraEstimate(drive);
  PrintLearnedMask(drive);
}

template <typename Frames>
void WriteResults(const std::filesystem::path& file, const Frames& frames) {
  if (file.empty()) {
    return;
  }
  std::string lines;
  for (const auto& frame : frames) {
    lines += ToJsonLine(frame) + "\n";
  }
  WriteFileAtomically(file, lines);
}

void LocalizeOnly(const Arguments& a, const Localizer& localizer, const Survey& survey) {
  const std::vector<LocalizedFrame> frames = LocalizeFrames(localizer, survey, a.options);
  WriteFileAtomically(a.out, FormatTum(ToTrajectory(frames)));
  WriteResults(a.results, frames);
  PrintSummary(frames);
  PrintCompression(frames);
}

void LocalizeAndFuse(Arguments& a, const Localizer& localizer, const Survey& survey) {
  a.fusion.tracker.method = ParseFusionMethod(a.fusion_method);
  a.fusion.use_prior = !(a.prior_given && a.options.prior == PriorSource::kNone);
  a.fusion.use_imu = !a.no_imu;
  a.fusion.correct_camera = a.options.correct_camera;
  a.fusion.run.progress = a.options.run.progress;
  const FusedDrive drive = FuseFrames(localizer, survey, a.fusion);
  WriteFileAtomically(a.out, FormatTum(ToTrajectory(drive.poses)));
  WriteResults(a.results, drive.frames);
  std::vector<LocalizedFrame> frames;
  for (const FusedFrame& frame : drive.frames) {
    frames.push_back(frame.localized);
  }
  PrintSummary(frames);
  PrintCompression(frames);
  PrintFusionSummary(drive);
}

LocalizerOptions MakeLocalizerOptions(const Arguments& a) {
  LocalizerOptions options;
  options.index.type = ParseMatcherType(a.matcher);
  options.index.seed = a.seed;
  options.registration.seed = a.seed;
  options.registration.max_p_wrong = a.max_p_wrong;
  return options;
}

void Run(Arguments& a) {
  CheckWritable(a.out);
  if (!a.results.empty()) {
    CheckWritable(a.results);
  }
  a.options.prior = ParsePriorSource(a.prior);
  a.options.run.progress = ProgressOutput::Stderr();
  if (a.fuse && a.options.prior == PriorSource::kTruth) {
    throw CLI::ValidationError("--fuse", "searches around the fused pose; leave --prior truth out");
  }
  const BagInput bag(a.bag, a.out, a.options.run.progress, BagInput::Lifetime::kTemporary);
  PrintWarnings(bag);
  const Survey survey = ReadSurvey(FolderOf(a.frames, bag));
  const MapDatabase database(a.map);
  const Localizer localizer(database.ReadMap(), MakeLocalizerOptions(a),
                            [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  if (a.fuse) {
    LocalizeAndFuse(a, localizer, survey);
  } else {
    LocalizeOnly(a, localizer, survey);
  }
  PrintMask(localizer.map().info, survey);
  if (a.options.correct_camera) {
    PrintCorrection(localizer.map().info, survey);
  }
}

void AddFusionOptions(CLI::App& command, Arguments& a) {
  auto* fuse = command.add_flag("--fuse", a.fuse,
                                "Fuse fixes, odometry, IMU and the motion between images; --out then "
                                "is the fused trajectory");
  command.add_option("--fusion-method", a.fusion_method, "ekf; to compare: increments, fixes, replace, jump_filter")
      ->check(CLI::IsMember({"ekf", "increments", "fixes", "replace", "jump_filter"}))
      ->needs(fuse)
      ->capture_default_str();
  command.add_flag("--dense", a.fusion.dense, "Fused poses at every message, not at the frames only")->needs(fuse);
  command.add_flag("--no-imu", a.no_imu, "Leave imu.csv out")->needs(fuse);
  command.add_flag("!--no-visual-odometry", a.fusion.tracker.visual_odometry, "Leave the motion between images out")
      ->needs(fuse);
  command
      .add_flag("!--no-learned-mask", a.fusion.tracker.mask.apply,
                "Report what stands still in the images while the floor moves, but don't leave it out")
      ->needs(fuse);
}

}  // namespace

void AddLocalizeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("localize", "Localizes every frame of a folder in a map");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--map", a->map, "Map file")->required();
  AddDriveOptions(command, &a->frames, &a->bag);
  command->add_option("--out", a->out, "Trajectory of the fixes to write (TUM)")->required();
  command->add_option("--results", a->results, "One JSON line per frame");
  auto* prior = command
                    ->add_option("--prior", a->prior,
                                 "none: whole map; odometry: the last fix propagated; truth. With --fuse: none, or "
                                 "else around the fused pose")
                    ->check(CLI::IsMember({"none", "odometry", "truth"}))
                    ->capture_default_str();
  command->add_option("--matcher", a->matcher, "Global search")
      ->check(CLI::IsMember({"auto", "hash", "flann", "brute_force"}))
      ->capture_default_str();
  command->add_option("--max-p-wrong", a->max_p_wrong, "Largest probability of being wrong that is accepted")
      ->check(CLI::Range(1e-300, 1.0))
      ->capture_default_str();
  command->add_flag("!--no-camera-correction", a->options.correct_camera,
                    "Use the camera as the folder has it, even if the map corrected it");
  command->add_option("--threads", a->options.run.threads, "0: one per core; with odometry, frames run one by one")
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Seed of all random choices")->capture_default_str();
  AddFusionOptions(*command, *a);
  command->callback([a, prior] {
    a->prior_given = prior->count() > 0;
    Run(*a);
  });
}

}  // namespace floorloc
