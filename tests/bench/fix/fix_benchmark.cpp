// SPDX-License-Identifier: Apache-2.0
// Speed and accuracy of a fix, compared with an OpenCV baseline. `./run bench` builds the map and starts it.
#include <CLI/CLI.hpp>
#include <exception>
#include <iomanip>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "core/io/survey.h"
#include "core/map/map_database.h"
#include "tests/bench/fix/table.h"

namespace floorloc {
namespace {

struct Arguments {
  std::string map;
  std::string mosaic;
  std::string survey;
  std::vector<std::string> frames;
  double build_seconds = 0.0;
};

// The compared methods; built once per map.
struct Contestants {
  Localizer localizer;
  Baseline brute_force;
  Baseline flann;
  Pose2 truth_from_map;
};

Column BaselineColumn(const std::string& title, const Baseline& baseline, const BenchFrames& frames,
                      const Pose2& truth_from_map) {
  const MethodRun run = RunBaseline(baseline, frames);
  return {title,
          std::to_string(baseline.map_keypoints()) + " kp",
          ComputeScore(run.fixes, frames.truth_from_base, truth_from_map, Tolerance()),
          {},
          {}};
}

Column LocalizerColumn(const std::string& subtitle, const Contestants& all, const BenchFrames& frames,
                       const Priors& priors) {
  const MethodRun run = RunLocalizer(all.localizer, frames, priors);
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  return {"floorloc", subtitle, ComputeScore(run.fixes, frames.truth_from_base, all.truth_from_map, Tolerance()),
          run.stages, MeasureFixesPerSecond(all.localizer, frames, priors, threads)};
}

void Compare(const Contestants& all, const BenchFrames& frames) {
  std::cout << "\nframes: " << frames.name << ", " << frames.size() << " with ground truth\n";
  PrintTable(std::cout, {
                            LocalizerColumn("with prior", all, frames,
                                            PerturbedPriors(frames.truth_from_base, all.truth_from_map)),
                            LocalizerColumn("global", all, frames, NoPriors(frames.size())),
                            BaselineColumn("SIFT + brute", all.brute_force, frames, all.truth_from_map),
                            BaselineColumn("SIFT + FLANN", all.flann, frames, all.truth_from_map),
                        });
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const MapDatabase database(arguments.map);
  const Survey survey = ReadSurvey(arguments.survey);
  const Mosaic mosaic = Mosaic::Read(arguments.mosaic);
  const std::size_t frames = database.ReadFrames().size();
  const Contestants all{Localizer(database.ReadMap(), LocalizerOptions(),
                                  [&](const TileId& tile) { return database.ReadMosaicTile(tile); }),
                        Baseline(mosaic, BaselineMatcher::kBruteForce, BaselineOptions()),
                        Baseline(mosaic, BaselineMatcher::kFlann, BaselineOptions()),
                        AlignMapToTruth(database.ReadFrames(), survey.ground_truth)};
  const FloorMap& map = all.localizer.map();
  std::cout << std::fixed << std::setprecision(1) << "map: " << map.info.area_m2 << " m2, " << map.keypoints.size()
            << " keypoints (" << ToString(map.info.extractor.type) << "), " << frames << " of " << survey.frames.size()
            << " survey frames placed\n"
            << "build: " << arguments.build_seconds << " s, "
            << static_cast<double>(survey.frames.size()) / arguments.build_seconds << " frames/s\n"
            << "Times are medians on one core, errors those of all localized frames; a success is within 10 mm and\n"
               "1 degree of the truth, wrong is a pose beyond. The map was aligned to the truth by its own frames.\n";
  for (const std::string& folder : arguments.frames) {
    Compare(all, BenchFrames::Read(folder));
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Times and scores fixes in a map, beside a plain OpenCV baseline.", "fix_benchmark");
  app.add_option("--map", arguments.map, "Map file")->required();
  app.add_option("--mosaic", arguments.mosaic, "Exported mosaic (PNG) with its world file")->required();
  app.add_option("--survey", arguments.survey, "Survey folder the map was built from")->required();
  app.add_option("--frames", arguments.frames, "Folders with frames and ground truth")->required();
  app.add_option("--build-seconds", arguments.build_seconds, "How long the build took")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "fix_benchmark: " << error.what() << "\n";
    return 1;
  }
}
