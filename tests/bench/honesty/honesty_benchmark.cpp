// SPDX-License-Identifier: Apache-2.0
// Calibration of the localizer's confidence: wrong fixes, covariance and p_wrong over many simulated frames.
// `./run bench honesty` starts it; it resumes where it was stopped.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/simulation/simulated_noise.h"
#include "tests/bench/common/state_folder.h"
#include "tests/bench/honesty/honesty_report.h"
#include "tests/bench/honesty/result_file.h"
#include "tests/bench/scenes/frame_runner.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr int kChunk = 64;  // frames between two writes
constexpr int kProbes = 8;  // frames of a stopped run that are repeated before resuming

struct Arguments {
  int frames = 100000;
  std::uint64_t seed = 1;
  std::string state;
  std::string photograph;
  int threads = 0;
  std::string overlay;
  double overlay_share = 0.13;
  std::vector<std::string> floors;
  bool restart = false;
  bool rebuild = false;
};

// Common to all floors.
struct Bench {
  Arguments arguments;
  std::vector<FloorCase> floors;
  std::vector<ConditionCase> conditions;
  std::vector<GrayFloor> images;  // one per floor, in its surveyed state

  FloorFiles Files(std::size_t floor) const { return {arguments.state, floors[floor].name}; }
  fs::path Results(std::size_t floor) const { return fs::path(arguments.state) / (floors[floor].name + ".jsonl"); }
};

// The same overlay in view of the survey and of the vehicles.
void AddOverlay(const OverlayOptions& overlay, Bench* bench) {
  const auto shown = OverlayOfBenchCamera(overlay);
  for (FloorCase& floor : bench->floors) {
    floor.overlay = overlay;
  }
  for (ConditionCase& condition : bench->conditions) {
    condition.overlay = shown;
  }
  bench->arguments.state +=
      "-" + std::string(ToString(overlay.kind)) + "-" + std::to_string(std::lround(100.0 * overlay.share));
}

void ChooseFloors(const std::vector<std::string>& names, Bench* bench) {
  if (names.empty()) {
    return;
  }
  std::erase_if(bench->floors, [&](const FloorCase& floor) {
    return std::find(names.begin(), names.end(), floor.name) == names.end();
  });
  if (bench->floors.size() != names.size() || names.size() < 2) {
    throw std::invalid_argument("--floors needs two or more of concrete, carpet, wood, photo, tiles, more-tiles");
  }
}

Bench Prepare(const Arguments& given) {
  Bench bench{given, FloorCases(given.photograph), ConditionCases(), {}};
  ChooseFloors(given.floors, &bench);
  if (!given.overlay.empty()) {
    OverlayOptions overlay;
    overlay.kind = ParseOverlayKind(given.overlay);
    overlay.share = given.overlay_share;
    AddOverlay(overlay, &bench);
  }
  const Arguments& arguments = bench.arguments;
  if (arguments.rebuild) {
    ClearStateFolder(arguments.state, "honesty_benchmark");
  } else {
    OpenStateFolder(arguments.state, "honesty_benchmark");
  }
  for (std::size_t i = 0; i < bench.floors.size(); ++i) {
    if (arguments.restart) {
      fs::remove(bench.Results(i));
    }
    PrepareFloor(bench.Files(i), bench.floors[i], ProgressOutput::Stderr());
    bench.images.push_back(ReadGrayFloor(bench.Files(i), 0.0));
  }
  return bench;
}

FrameRunner MakeRunner(const Bench& bench, std::size_t index, const BenchFloor& floor) {
  FramePlanner planner{bench.floors[index],
                       MakeDownwardCamera().floor.roi,
                       bench.conditions.size(),
                       {},
                       DeriveSeed(bench.arguments.seed, index)};
  std::vector<const GrayFloor*> others;
  for (std::size_t i = 0; i < bench.floors.size(); ++i) {
    if (i != index) {
      others.push_back(&bench.images[i]);
      planner.other_sizes_m.emplace_back(bench.floors[i].texture.width_m, bench.floors[i].texture.height_m);
    }
  }
  return {floor, planner, others, bench.conditions};
}

std::vector<FrameRecord> RunFrames(const FrameRunner& runner, int first, int count, int threads) {
  std::vector<FrameRecord> records(static_cast<std::size_t>(count));
  ParallelFor(count, threads, [&](int i) { records[static_cast<std::size_t>(i)] = runner.Run(first + i); });
  return records;
}

// Results of programs that give different results must not be mixed.
void CheckStillTheSame(const FrameRunner& runner, const std::vector<FrameRecord>& records, const fs::path& file) {
  const std::size_t step = std::max<std::size_t>(1, records.size() / kProbes);
  for (std::size_t i = 0; i < records.size(); i += step) {
    if (!SameAnswers(runner.Run(static_cast<int>(i)), records[i])) {
      throw InputError(file, static_cast<int>(i) + 2,
                       "is not what the program answers today; begin anew with --restart");
    }
  }
}

std::vector<FrameRecord> RunFloor(const Bench& bench, std::size_t index) {
  const BenchFloor floor = ReadBenchFloor(bench.Files(index), bench.conditions);
  const FrameRunner runner = MakeRunner(bench, index, floor);
  const std::string& name = bench.floors[index].name;
  const nlohmann::ordered_json title = {
      {"floor", name}, {"seed", bench.arguments.seed}, {"map", floor.localizer->map().info.content_version}};
  ResultFile results(bench.Results(index), title.dump());
  CheckStillTheSame(runner, results.records(), bench.Results(index));
  const auto floors = static_cast<int>(bench.floors.size());
  const int wanted = (bench.arguments.frames + floors - 1) / floors;
  const auto done = static_cast<int>(results.records().size());
  std::cerr << name << ": " << floor.localizer->map().keypoints.size() << " map keypoints, map frames are "
            << 1000.0 * floor.map_rms_m << " mm off (RMS), " << done << " frames done\n";
  ProgressBar progress(name, std::max(0, wanted - done), ProgressOutput::Stderr());
  for (int first = done; first < wanted; first += kChunk) {
    const int count = std::min(kChunk, wanted - first);
    results.Append(RunFrames(runner, first, count, bench.arguments.threads));
    progress.Advance(count);
  }
  return results.records();
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const Bench bench = Prepare(arguments);
  FloorRecords records;
  for (std::size_t i = 0; i < bench.floors.size(); ++i) {
    records[bench.floors[i].name] = RunFloor(bench, i);
  }
  const HonestyReport report = Summarize(records);
  const fs::path folder(bench.arguments.state);
  WriteFileAtomically(folder / "honesty.json", ToJson(report));
  WriteFileAtomically(folder / "reliability.svg", DrawReliability(report));
  PrintReport(std::cout, report);
  std::cout << "\nreport: " << (folder / "honesty.json").string()
            << ", diagram: " << (folder / "reliability.svg").string() << '\n';
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Counts wrong fixes and checks covariance and p_wrong on simulated floors.", "honesty_benchmark");
  app.add_option("--frames", arguments.frames, "Frames over all floors")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the frames")->capture_default_str();
  app.add_option("--state", arguments.state, "Folder of maps and results")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor to make one of")->required();
  app.add_option("--threads", arguments.threads, "Number of threads; 0: one per core")->capture_default_str();
  app.add_option("--overlay", arguments.overlay,
                 "In view of survey and vehicle: part, text, logo, dirt or lamp; maps and results are kept apart")
      ->check(CLI::IsMember(floorloc::OverlayKindNames()));
  app.add_option("--overlay-share", arguments.overlay_share, "Share of the image that it covers")
      ->capture_default_str();
  app.add_option("--floors", arguments.floors, "Two or more of the floors, NAME,NAME,...; all by default")
      ->delimiter(',');
  app.add_flag("--restart", arguments.restart, "Forget the results; after a change of the localizer");
  app.add_flag("--rebuild", arguments.rebuild, "Forget the maps too; after a change of features or builder");
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "honesty_benchmark: " << error.what() << "\n";
    return 1;
  }
}
