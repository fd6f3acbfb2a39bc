// SPDX-License-Identifier: Apache-2.0
// Accuracy and honesty of fixes with a camera whose calibration is a little wrong, beside SIFT and RANSAC on the same
// mosaic. `./run bench calibration` starts it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "tests/bench/calibration/calibration_trial.h"
#include "tests/bench/calibration/readout_trial.h"

namespace floorloc {
namespace {

struct Arguments {
  std::string state;
  std::string photograph;
  std::vector<std::string> recorded;  // a survey, then folders of frames
  std::vector<std::string> cases;
  int frames = 40;
  bool learn = false;
  std::optional<double> calibration_sigma_px;
  std::optional<double> systematic_m;
  std::optional<double> unmodelled_px;
  std::vector<std::string> self_calibrate{"auto"};
};

bool Wanted(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

void PrintRow(const CalibrationRow& row) {
  const CalibrationScore& a = row.floorloc;
  const CalibrationScore& b = row.sift;
  std::printf("  %-8s %3d/%d  %5.2f  %5.2f  %6.1f      %3d/%d  %5.2f  %5.2f\n", row.group.c_str(), a.localized,
              a.frames, 1e3 * a.median_m, 1e3 * a.p95_m, a.mean_nees, b.localized, b.frames, 1e3 * b.median_m,
              1e3 * b.p95_m);
}

void Print(const std::string& name, const CalibrationResult& result) {
  std::printf("%s: survey rms %.2f mm, built in %.1f s\n", name.c_str(), 1e3 * result.map_rms_m, result.build_s);
  for (const CalibrationRow& row : result.rows) {
    PrintRow(row);
  }
  std::fflush(stdout);
}

void PrintReadout(const ReadoutRow& row) {
  const auto print = [](const char* name, const CalibrationScore& score) {
    std::printf("  %s %3d/%d  %5.2f  %5.2f  %6.1f", name, score.localized, score.frames, 1e3 * score.median_m,
                1e3 * score.p95_m, score.mean_nees);
  };
  std::printf("%2.0f ms", 1e3 * row.readout_s);
  print("given", row.given);
  print("unknown", row.unknown);
  print("ignored", row.ignored);
  std::printf("  learnt %.2f +- %.2f ms\n", 1e3 * row.learnt_s, 1e3 * row.learnt_sigma_s);
  std::fflush(stdout);
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  if (arguments.cases == std::vector<std::string>{"readout"}) {
    std::printf("Errors of the fixes in mm at 1 m/s: found, median, 95 %%, mean NEES; ideally 3\n");
    RunReadouts({arguments.state, arguments.photograph, arguments.frames}, PrintReadout);
    return;
  }
  std::printf(
      "Errors in mm after the offset of map and base frame that no image can tell; NEES: mean of (x, y, yaw), ideally "
      "3\n"
      "  %-8s %-7s %-6s %-6s %-10s  SIFT + RANSAC: found, median, 95 %%\n",
      "frames", "found", "median", "95 %", "NEES");
  BuildOptions build;
  ParseCameraUnknowns(arguments.self_calibrate, &build.self_calibration);
  build.self_calibration.unmodelled_px = arguments.unmodelled_px.value_or(build.self_calibration.unmodelled_px);
  LocalizerOptions localizer;
  localizer.photometric.calibration_sigma_px =
      arguments.calibration_sigma_px.value_or(localizer.photometric.calibration_sigma_px);
  localizer.systematic_m = arguments.systematic_m.value_or(localizer.systematic_m);
  if (!arguments.recorded.empty()) {
    std::filesystem::create_directories(arguments.state);
    build.out = std::filesystem::path(arguments.state) / "recorded.floormap";
    const std::vector<std::filesystem::path> groups(arguments.recorded.begin() + 1, arguments.recorded.end());
    Print(arguments.recorded.front(),
          RunRecorded(arguments.recorded.front(), groups, {build, localizer, arguments.learn}));
    return;
  }
  const CalibrationScene scene = MakeCalibrationScene(arguments.state, arguments.photograph, arguments.frames);
  for (const CalibrationCase& test : CalibrationCases()) {
    if (Wanted(arguments.cases, test.name)) {
      Print(test.name, RunCase(scene, test, {build, localizer, arguments.learn}));
    }
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Localizes with cameras whose calibration is a little wrong.", "calibration_benchmark");
  app.add_option("--state", arguments.state, "Folder for recordings and maps; recordings are made once")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor")->required();
  app.add_option("recorded", arguments.recorded,
                 "Recorded survey and folders of frames with ground truth, instead of the simulated cases");
  app.add_option("--systematic", arguments.systematic_m, "LocalizerOptions::systematic_m, metres");
  app.add_option("--case", arguments.cases, "Only these cases, by name; readout: rolling shutters alone");
  app.add_option("--frames", arguments.frames, "Frames per group")->capture_default_str();
  app.add_flag("--learn", arguments.learn,
               "Also as a vehicle that learns its camera: the rows above each group are of its second half");
  app.add_option("--calibration-sigma", arguments.calibration_sigma_px,
                 "What the localizer takes the calibration to be worth, pixels; 0: exact");
  app.add_option("--unmodelled", arguments.unmodelled_px, "What no unknown of the self-calibration describes, pixels");
  app.add_option("--self-calibrate", arguments.self_calibrate, "As of `floorloc-mapbuilder build`")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "calibration_benchmark: " << error.what() << "\n";
    return 1;
  }
}
