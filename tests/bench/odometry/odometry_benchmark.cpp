// SPDX-License-Identifier: Apache-2.0
// Planar visual odometry by features and by KLT: speed and drift at several frame rates.
// `./run bench odometry` starts it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <numbers>
#include <opencv2/core/utility.hpp>

#include "mapbuilder/batch/progress.h"
#include "tests/bench/odometry/odometry_methods.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kThinning[] = {1, 2, 4};

struct Arguments {
  BenchDriveOptions drives;
  std::string overlay;
  double overlay_share = 0.3;
  std::vector<fs::path> folders;
};

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::nan("");
  }
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

double Rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) {
    sum += v * v;
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) {
    sum += v;
  }
  return sum / static_cast<double>(values.size());
}

void PrintHead() {
  std::printf("%-26s %-5s %-21s %8s %8s %7s %6s %8s %8s %8s %8s %7s %7s\n", "drives", "rate", "method", "prepare",
              "track", "lost", "wrong", "motion", "turn", "drift", "drift", "NEES", "NEES");
  std::printf("%-26s %-5s %-21s %8s %8s %7s %6s %8s %8s %8s %8s %7s %7s\n", "", "", "", "ms", "ms", "%", "", "mm",
              "deg", "%", "deg/m", "motion", "summed");
}

void PrintRow(const std::string& drives, std::size_t thinning, const std::string& method, const DriftTally& t) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::printf("%-26s 1/%-3zu %-21s %8.2f %8.2f %7.1f %6d %8.3f %8.4f %8.3f %8.4f %7.2f %7.2f\n", drives.c_str(),
              thinning, method.c_str(), Quantile(t.extract_ms, 0.5), Quantile(t.track_ms, 0.5),
              100.0 * t.lost / std::max(t.frames, 1), t.wrong, 1e3 * Rms(t.motion_m), kDegrees * Rms(t.motion_rad),
              100.0 * Rms(t.drift_share), kDegrees * Rms(t.drift_rad_per_m), Mean(t.nees_alone), Mean(t.nees_summed));
}

// Drives of the same group are counted together.
void RunGroup(const std::string& name, const std::vector<fs::path>& folders) {
  const std::vector<OdometryMethod> methods = OdometryMethods();
  std::map<std::pair<std::size_t, std::size_t>, DriftTally> tallies;
  ProgressBar progress(name, static_cast<std::int64_t>(folders.size()), ProgressOutput::Stderr());
  for (const fs::path& folder : folders) {
    const Drive drive = ReadDrive(folder);
    for (const std::size_t thinning : kThinning) {
      const Drive thin = Thin(drive, thinning);
      for (std::size_t m = 0; m < methods.size(); ++m) {
        AddDrift(methods[m].run(thin), thin.truth_from_base, &tallies[{thinning, m}]);
      }
    }
    progress.Advance();
  }
  for (const auto& [key, tally] : tallies) {
    PrintRow(name, key.first, methods[key.second].name, tally);
  }
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  std::map<std::string, std::vector<fs::path>> groups;
  BenchDriveOptions drives = arguments.drives;
  if (!arguments.overlay.empty()) {
    drives.overlay.kind = ParseOverlayKind(arguments.overlay);
    drives.overlay.share = arguments.overlay_share;
  }
  for (const BenchDrive& drive : SimulateDrives(drives)) {
    groups["five floors, " + drive.condition].push_back(drive.folder);
  }
  for (const fs::path& folder : arguments.folders) {
    const std::string name = folder.string();
    groups[name.size() > 26 ? "..." + name.substr(name.size() - 23) : name].push_back(folder);
  }
  std::cout << "prepare: contrast and features; track: matching or KLT, and registration; medians of the thread's "
               "time.\nlost: of the frames; wrong: motions off by 20 mm or 2 degrees. motion, turn: RMS errors between "
               "frames.\ndrift: RMS over stretches of half a metre. NEES: 3 is exact; of motions, and summed since "
               "the last keyframe.\n";
  PrintHead();
  for (const auto& [name, folders] : groups) {
    RunGroup(name, folders);
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Measures planar visual odometry by features and by KLT on simulated and recorded drives.",
               "odometry_benchmark");
  app.add_option("--state", arguments.drives.state, "Folder of simulated drives")->required();
  app.add_option("--photograph", arguments.drives.photograph, "Image of a floor to make one of")->required();
  app.add_option("--frames", arguments.drives.frames, "Of each simulated drive")
      ->check(CLI::Range(20, 100000))
      ->capture_default_str();
  auto* overlay = app.add_option("--overlay", arguments.overlay, "What stands still in the images; the vehicle stops")
                      ->check(CLI::IsMember(floorloc::OverlayKindNames()));
  app.add_option("--overlay-share", arguments.overlay_share, "Share of the image that it covers")
      ->needs(overlay)
      ->check(CLI::Range(0.01, 0.9))
      ->capture_default_str();
  app.add_option("folders", arguments.folders, "Recorded drives with ground truth, in the survey format");
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "odometry_benchmark: " << error.what() << "\n";
    return 1;
  }
}
