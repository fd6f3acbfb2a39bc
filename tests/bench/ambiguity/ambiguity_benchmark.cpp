// SPDX-License-Identifier: Apache-2.0
// How long a vehicle that is switched on in a tiled hall drives until it knows where it is. `./run bench ambiguity`
// starts it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "core/io/text_file.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/simulation/simulated_noise.h"
#include "mapbuilder/simulation/tile_floor.h"
#include "tests/bench/ambiguity/ambiguity_table.h"
#include "tests/bench/common/state_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path state;
  std::vector<std::string> floors = {"tiles", "tiles-identical", "tiles-grout", "tiles-singular-1", "tiles-singular-5"};
  std::vector<std::string> conditions = {"mild", "hard"};
  int tiles = 20;
  int drives = 4;
  int starts = 50;
  double follow_m = 20.0;
  HallDriveOptions drive;
  int threads = 0;
  fs::path json;
  bool rebuild = false;
};

// Of all starts of a drive, method by method.
using Outcomes = std::vector<std::vector<StartOutcome>>;

Outcomes ReplayStarts(const RecordedDrive& drive, const Hall& hall, const Localizer& localizer,
                      const Arguments& arguments) {
  const std::vector<std::string> methods = StartMethodNames();
  Outcomes outcomes(methods.size());
  for (const StartPlan& plan : PlanStarts(drive, arguments.starts, arguments.follow_m)) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const auto method = MakeStartMethod(methods[i], localizer, DeriveSeed(arguments.drive.seed, plan.frame));
      outcomes[i].push_back(ReplayStart(drive, hall, plan, method.get()));
    }
  }
  return outcomes;
}

AmbiguityRow RunCondition(const Hall& hall, const BenchFloor& floor, const std::vector<ConditionCase>& conditions,
                          std::size_t look, const Arguments& arguments) {
  const ConditionCase& condition = conditions[look];
  AmbiguityRow row{hall.floor.name, condition.name, hall.tiles, floor.map_rms_m, {}, {}};
  const auto count = static_cast<std::size_t>(arguments.drives);
  std::vector<RecordedDrive> drives(count);
  std::vector<Outcomes> outcomes(count);
  ProgressBar progress(row.floor + ", " + row.condition + ": drives", arguments.drives, ProgressOutput::Stderr());
  ParallelFor(arguments.drives, arguments.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    HallDriveOptions options = arguments.drive;
    options.seed = DeriveSeed(arguments.drive.seed, index);
    drives[index] = RecordDrive(hall, floor, condition, look, options);
    outcomes[index] = ReplayStarts(drives[index], hall, *floor.localizer, arguments);
    progress.Advance();
  });
  row.frames = ScoreFrames(drives);
  for (std::size_t method = 0; method < StartMethodNames().size(); ++method) {
    std::vector<StartOutcome> all;
    for (const Outcomes& of_drive : outcomes) {
      all.insert(all.end(), of_drive[method].begin(), of_drive[method].end());
    }
    row.starts.push_back(ScoreStarts(all));
  }
  return row;
}

std::vector<AmbiguityRow> RunHall(const Hall& hall, const Arguments& arguments) {
  const FloorFiles files = hall.Files(arguments.state);
  PrepareFloor(files, hall.floor, ProgressOutput::Stderr());
  std::vector<ConditionCase> conditions = HallConditions();
  std::erase_if(conditions,
                [&](const ConditionCase& c) { return std::ranges::count(arguments.conditions, c.name) == 0; });
  const BenchFloor floor = ReadBenchFloor(files, conditions);
  std::cerr << files.name << ": map frames are " << 1000.0 * floor.map_rms_m << " mm off (RMS)\n";
  std::vector<AmbiguityRow> rows;
  for (std::size_t look = 0; look < conditions.size(); ++look) {
    rows.push_back(RunCondition(hall, floor, conditions, look, arguments));
  }
  return rows;
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  arguments.drive.Check();
  if (arguments.rebuild) {
    ClearStateFolder(arguments.state, "ambiguity_benchmark");
  } else {
    OpenStateFolder(arguments.state, "ambiguity_benchmark");
  }
  std::vector<AmbiguityRow> rows;
  for (const std::string& name : arguments.floors) {
    const std::vector<AmbiguityRow> of_hall = RunHall(MakeHall(name, arguments.tiles), arguments);
    rows.insert(rows.end(), of_hall.begin(), of_hall.end());
    if (!arguments.json.empty()) {
      WriteFileAtomically(arguments.json, ToJson(StartMethodNames(), rows));
    }
  }
  std::cout << arguments.tiles << " x " << arguments.tiles << " tiles\n\n";
  PrintAmbiguity(std::cout, StartMethodNames(), rows);
}

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--state", a.state, "Folder of floors and maps")->required();
  app.add_option("--floors", a.floors, "Of the tiled floors of simulate --texture, NAME,NAME,...")
      ->delimiter(',')
      ->check(CLI::IsMember(TileFloorNames()))
      ->capture_default_str();
  app.add_option("--conditions", a.conditions, "mild, hard")
      ->delimiter(',')
      ->check(CLI::IsMember({"mild", "hard"}))
      ->capture_default_str();
  app.add_option("--tiles", a.tiles, "Tiles along each side of the hall")
      ->check(CLI::Range(6, 40))
      ->capture_default_str();
  app.add_option("--drives", a.drives, "Per floor and condition")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--metres", a.drive.metres, "Length of a drive")->capture_default_str();
  app.add_option("--spacing", a.drive.spacing_m, "Metres between frames")->capture_default_str();
  app.add_option("--starts", a.starts, "Cold starts per drive")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--follow", a.follow_m, "Metres for which a start is followed")->capture_default_str();
  app.add_option("--seed", a.drive.seed, "Of the drives")->capture_default_str();
  app.add_option("--threads", a.threads, "Number of threads; 0: one per core")->capture_default_str();
  app.add_option("--json", a.json, "File for all numbers; written after every floor");
  app.add_flag("--rebuild", a.rebuild, "Forget the maps; after a change of features or builder");
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Switches vehicles on in tiled halls and counts the metres until they know where they are.",
               "ambiguity_benchmark");
  floorloc::AddOptions(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "ambiguity_benchmark: " << error.what() << "\n";
    return 1;
  }
}
