// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/io/text_file.h"
#include "mapbuilder/cli/bag_input.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/replay/odometry_frames.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path frames, out, results, scale_from;
  BagArguments bag;
  std::string mode = "planar";
  std::string features;
  std::string prior = "none";
  int border_px = 0;
  int threads = 1;
  std::uint32_t seed = 1;
  bool json = false;
};

// Summary of a run in either mode.
struct Summary {
  int frames = 0;
  int tracked = 0;  ///< with a motion, without the first frame
  int lost = 0;
  int breaks = 0;  ///< gaps in the path (planar), or losses of the scale (monocular)
  int keyframes = 0;
  double length = 0.0;  ///< of the path; metres, or units
  std::vector<double> frame_ms;
};

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double LengthOf(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].translation_m - trajectory[i - 1].translation_m).norm();
  }
  return length;
}

Summary Summarize(const std::vector<PlanarFrame>& frames) {
  Summary summary;
  for (const PlanarFrame& f : frames) {
    summary.tracked += f.result.status == PlanarOdometryStatus::kTracked ? 1 : 0;
    summary.lost += f.result.status == PlanarOdometryStatus::kLost ? 1 : 0;
    summary.breaks = f.result.chain;
    summary.keyframes += f.result.new_keyframe ? 1 : 0;
    summary.frame_ms.push_back(f.decode_ms + f.features_ms + f.track_ms);
  }
  return summary;
}

Summary Summarize(const std::vector<MonocularFrame>& frames) {
  Summary summary;
  for (const MonocularFrame& f : frames) {
    const MonocularStatus status = f.result.status;
    summary.tracked += status == MonocularStatus::kTracked || status == MonocularStatus::kRotated ? 1 : 0;
    summary.lost += status == MonocularStatus::kLost ? 1 : 0;
    summary.breaks = f.result.scale_breaks;
    summary.keyframes += f.result.new_keyframe ? 1 : 0;
    summary.frame_ms.push_back(f.decode_ms + f.track_ms);
  }
  return summary;
}

void Print(const Summary& s, const Arguments& a) {
  const bool planar = a.mode == "planar";
  const bool metres = planar || !a.scale_from.empty();
  if (a.json) {
    const nlohmann::ordered_json json = {{"mode", a.mode},
                                         {"frames", s.frames},
                                         {"tracked", s.tracked},
                                         {"lost", s.lost},
                                         {planar ? "breaks" : "scale_breaks", s.breaks},
                                         {"keyframes", s.keyframes},
                                         {metres ? "length_m" : "length_units", s.length},
                                         {"median_ms", Median(s.frame_ms)}};
    std::cout << json.dump(2) << "\n";
    return;
  }
  std::printf("%d frames: %d tracked, %d lost; %.3f %s, %d keyframes; median %.1f ms per frame\n", s.frames, s.tracked,
              s.lost, s.length, metres ? "m" : "units", s.keyframes, Median(s.frame_ms));
  if (s.breaks > 0) {
    std::printf("%d times the %s was lost: the parts before and after are not connected\n", s.breaks,
                planar ? "way" : "scale");
  }
}

template <typename Frames>
void WriteAndPrint(const Frames& frames, const Arguments& a) {
  const Trajectory trajectory = ToTrajectory(frames);
  WriteFileAtomically(a.out, FormatTum(trajectory));
  if (!a.results.empty()) {
    std::string lines;
    for (const auto& frame : frames) {
      lines += ToJsonLine(frame) + "\n";
    }
    WriteFileAtomically(a.results, lines);
  }
  Summary summary = Summarize(frames);
  summary.frames = static_cast<int>(frames.size());
  summary.length = LengthOf(trajectory);
  Print(summary, a);
}

void RunPlanar(const Arguments& a) {
  if (!a.scale_from.empty() || a.border_px > 0) {
    throw std::invalid_argument(
        "--scale-from and --border belong to --mode monocular; a planar camera's scale and region of interest are in "
        "floor.yaml");
  }
  PlanarFramesOptions options;
  options.extractor.type = a.features.empty() ? options.extractor.type : ParseExtractorType(a.features);
  options.odometry.registration.seed = a.seed;
  options.use_wheels = a.prior == "odometry";
  options.run.threads = a.threads;
  options.run.progress = ProgressOutput::Stderr();
  WriteAndPrint(TrackPlanarFrames(ReadSurvey(a.frames), options), a);
}

void RunMonocular(const Arguments& a) {
  if (a.prior != "none") {
    throw std::invalid_argument("--prior belongs to --mode planar; use --scale-from for the scale");
  }
  MonocularFramesOptions options;
  options.odometry.tracker.detector =
      a.features.empty() ? options.odometry.tracker.detector : ParsePointDetector(a.features);
  options.odometry.tracker.border_px = a.border_px;
  if (!a.scale_from.empty()) {
    options.positions = ReadTrajectory(a.scale_from);
  }
  options.run.progress = ProgressOutput::Stderr();
  WriteAndPrint(TrackMonocularFrames(ReadCameraRecording(a.frames), options), a);
}

void Run(Arguments& a) {
  CheckWritable(a.out);
  if (!a.results.empty()) {
    CheckWritable(a.results);
  }
  a.bag.choice.needs_floor = a.mode == "planar";
  const BagInput bag(a.bag, a.out, ProgressOutput::Stderr(), BagInput::Lifetime::kTemporary);
  PrintWarnings(bag);
  a.frames = FolderOf(a.frames, bag);
  if (a.mode == "planar") {
    RunPlanar(a);
  } else {
    RunMonocular(a);
  }
}

}  // namespace

void AddOdometryCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("odometry", "Measures the motion from frame to frame, without a map");
  const auto a = std::make_shared<Arguments>();
  AddDriveOptions(command, &a->frames, &a->bag);
  command
      ->add_option("--out", a->out,
                   "Trajectory to write (TUM): of the base, starting at odometry.tum's pose; monocular: of the camera, "
                   "x right, y down, z forward, in the first frame's axes")
      ->required();
  command->add_option("--results", a->results, "One JSON line per frame");
  command->add_option("--mode", a->mode, "planar: the camera sees the floor; monocular: anything, up to scale")
      ->check(CLI::IsMember({"planar", "monocular"}))
      ->capture_default_str();
  command->add_option(
      "--features", a->features,
      "planar: hessian (default), orb, sift, akaze, brisk, surf; monocular: orb (default), brisk, akaze");
  command
      ->add_option("--prior", a->prior,
                   "planar: none, or odometry: frames are searched around odometry.tum's prediction")
      ->check(CLI::IsMember({"none", "odometry"}))
      ->capture_default_str();
  command->add_option("--scale-from", a->scale_from, "monocular: trajectory whose distances give the scale");
  command->add_option("--border", a->border_px, "monocular: rim of the image to leave out, pixels")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command->add_option("--threads", a->threads, "planar: for the features; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Seed of all random choices")->capture_default_str();
  command->add_flag("--json", a->json, "Print the summary as JSON");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
