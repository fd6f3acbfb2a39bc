// SPDX-License-Identifier: Apache-2.0
// Global search on floors of growing area: a real map among synthetic keypoints. `./run bench index` starts it.
#include <CLI/CLI.hpp>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/io/survey.h"
#include "core/map/map_database.h"
#include "core/vision/extractors/feature_extractor.h"
#include "tests/bench/common/bench_frames.h"
#include "tests/bench/common/score.h"
#include "tests/bench/index/extrapolation.h"
#include "tests/bench/index/index_table.h"

namespace floorloc {
namespace {

struct Arguments {
  std::string map;
  std::string survey;
  std::string frames;
  std::vector<double> areas = {24, 100, 1000, 10000, 100000};
  bool independent_bits = false;
  double memory_gb = 0.0;
  double baseline_area_m2 = 1000.0;
};

// Half of the system's available memory.
double HalfOfFreeMemoryGb() {
  std::ifstream file("/proc/meminfo");
  std::string name;
  double kilobytes = 0.0;
  while (file >> name >> kilobytes) {
    if (name == "MemAvailable:") {
      return 0.5 * kilobytes / 1e6;
    }
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 2.0;
}

// Descriptors, positions, the index, and the temporary memory of its construction.
double MemoryGb(double area_m2) {
  constexpr double kBytesPerKeypoint = 56.0;
  return kBytesPerKeypoint * area_m2 * kKeypointsPerM2 / 1e9;
}

std::vector<QueryFrame> ReadFrames(const Arguments& arguments, const FloorMap& map, const Pose2& truth_from_map) {
  cv::setNumThreads(1);
  const auto extractor = CreateFeatureExtractor(map.info.extractor);
  const BenchFrames set = BenchFrames::Read(arguments.frames);
  std::vector<QueryFrame> frames;
  for (std::size_t i = 0; i < set.size(); ++i) {
    frames.push_back(
        {extractor->Extract(set.rectifier.Rectify(set.Decode(i))), truth_from_map.Inverse() * set.truth_from_base[i]});
  }
  return frames;
}

// Runs all methods on one floor; those that would take too long are extrapolated from `history`.
void CompareOn(double area_m2, const std::vector<IndexMethod>& methods, const Arguments& arguments,
               const std::function<std::vector<IndexTrial>(double)>& try_floor,
               std::map<std::string, std::vector<IndexTrial>>* history) {
  std::vector<IndexTrial> trials;
  if (MemoryGb(area_m2) <= arguments.memory_gb) {
    trials = try_floor(area_m2);
  }
  std::map<std::string, IndexTrial> row;
  for (const IndexTrial& trial : trials) {
    row[trial.method] = trial;
    (*history)[trial.method].push_back(trial);
  }
  for (const IndexMethod& method : methods) {
    if (row.count(method.name) == 0 && !(*history)[method.name].empty()) {
      row[method.name] = Extrapolate((*history)[method.name], area_m2);
    }
  }
  for (const IndexMethod& method : methods) {
    if (row.count(method.name) > 0 && row.count("brute force") > 0) {
      PrintTrial(std::cout, row[method.name], row["brute force"].search_ms);
    }
  }
}

void Run(Arguments arguments) {
  if (arguments.memory_gb <= 0.0) {
    arguments.memory_gb = HalfOfFreeMemoryGb();
  }
  const MapDatabase database(arguments.map);
  const FloorMap map = database.ReadMap();
  const Survey survey = ReadSurvey(arguments.survey);
  const Pose2 truth_from_map = AlignMapToTruth(database.ReadFrames(), survey.ground_truth);
  const std::vector<QueryFrame> frames = ReadFrames(arguments, map, truth_from_map);
  const double resolution_m = map.info.camera().floor.resolution_m;
  const std::vector<IndexMethod> methods =
      ComparedIndexes(RegistrationOptions().ScaledTo(resolution_m), arguments.baseline_area_m2);
  std::cout << "A real map of " << map.keypoints.size() << " keypoints in floors of " << kKeypointsPerM2
            << " made-up ones per m2 ("
            << (arguments.independent_bits ? "independent bits" : "bits correlated as in the map") << "); "
            << frames.size()
            << " frames.\nsearch: median processor time, from a frame's descriptors to its pose, one core. "
            << "~: extrapolated. Memory limit " << arguments.memory_gb << " GB.\n";
  PrintHead(std::cout);
  std::map<std::string, std::vector<IndexTrial>> history;
  for (const double area_m2 : arguments.areas) {
    const auto try_floor = [&](double area) {
      const auto dependence = arguments.independent_bits ? BitDependence::kIndependent : BitDependence::kCorrelated;
      DescriptorModel model(map.keypoints.descriptors, dependence, 1);
      const BigFloor floor(map, area, &model, 2);
      std::vector<IndexTrial> trials;
      for (const IndexMethod& method : methods) {
        if (area <= method.max_area_m2) {
          trials.push_back(TryIndex(method, floor, map, frames));
        }
      }
      return trials;
    };
    CompareOn(area_m2, methods, arguments, try_floor, &history);
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Times the global search on floors of growing size, beside brute force and FLANN.", "index_benchmark");
  app.add_option("--map", arguments.map, "Map file with binary descriptors")->required();
  app.add_option("--survey", arguments.survey, "Survey folder the map was built from")->required();
  app.add_option("--frames", arguments.frames, "Folder with frames and ground truth")->required();
  app.add_option("--areas", arguments.areas, "Floors to search, m2, increasing")->capture_default_str();
  app.add_flag("--independent-bits", arguments.independent_bits, "Make up descriptors without correlations");
  app.add_option("--memory-gb", arguments.memory_gb, "Larger floors are extrapolated; default: half of what is free");
  app.add_option("--baseline-area", arguments.baseline_area_m2, "On larger floors baselines are extrapolated")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(std::move(arguments));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "index_benchmark: " << error.what() << "\n";
    return 1;
  }
}
