// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/io/text_file.h"
#include "core/map/map_database.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/localize_frames.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map, frames, out, results;
  std::string prior = "none";
  std::string matcher = "auto";
  double max_p_wrong = RegistrationOptions().max_p_wrong;
  std::uint32_t seed = 1;
  LocalizeFramesOptions options;
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

void Run(Arguments& a) {
  CheckWritable(a.out);
  if (!a.results.empty()) {
    CheckWritable(a.results);
  }
  a.options.prior = ParsePriorSource(a.prior);
  a.options.progress = ProgressOutput::Stderr();
  LocalizerOptions localizer_options;
  localizer_options.index.type = ParseMatcherType(a.matcher);
  localizer_options.index.seed = a.seed;
  localizer_options.registration.seed = a.seed;
  localizer_options.registration.max_p_wrong = a.max_p_wrong;
  const Survey survey = ReadSurvey(a.frames);
  const MapDatabase database(a.map);
  const Localizer localizer(database.ReadMap(), localizer_options,
                            [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  const std::vector<LocalizedFrame> frames = LocalizeFrames(localizer, survey, a.options);
  WriteFileAtomically(a.out, FormatTum(ToTrajectory(frames)));
  if (!a.results.empty()) {
    std::string lines;
    for (const LocalizedFrame& frame : frames) {
      lines += ToJsonLine(frame) + "\n";
    }
    WriteFileAtomically(a.results, lines);
  }
  PrintSummary(frames);
}

}  // namespace

void AddLocalizeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("localize", "Localizes every frame of a folder in a map");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--map", a->map, "Map file")->required();
  command->add_option("--frames", a->frames, "Folder in the survey format")->required();
  command->add_option("--out", a->out, "Trajectory of the fixes to write (TUM)")->required();
  command->add_option("--results", a->results, "One JSON line per frame");
  command->add_option("--prior", a->prior, "none: whole map; odometry: carried on from the last fix; truth")
      ->check(CLI::IsMember({"none", "odometry", "truth"}))
      ->capture_default_str();
  command->add_option("--matcher", a->matcher, "Global search")
      ->check(CLI::IsMember({"auto", "hash", "flann", "brute_force"}))
      ->capture_default_str();
  command->add_option("--max-p-wrong", a->max_p_wrong, "A pose that is wrong with a higher probability is not accepted")
      ->check(CLI::Range(1e-300, 1.0))
      ->capture_default_str();
  command->add_option("--threads", a->options.threads, "0: one per core; with odometry, frames run one by one")
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Of all random choices")->capture_default_str();
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
