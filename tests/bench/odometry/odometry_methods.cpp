// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/odometry/odometry_methods.h"

#include <ctime>

#include "core/vision/extractors/feature_extractor.h"
#include "tests/bench/odometry/klt_odometry.h"

namespace floorloc {
namespace {

// CPU time of this thread, milliseconds.
double ThreadMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

PlanarOdometryOptions OptionsFor(const Drive& drive) {
  PlanarOdometryOptions options;
  options.resolution_m = drive.camera.floor.resolution_m;
  return options;
}

std::optional<Pose2> GuessAt(const Drive& drive, std::size_t frame) {
  if (frame == 0 || !drive.odom_from_base[frame] || !drive.odom_from_base[frame - 1]) {
    return std::nullopt;
  }
  return drive.odom_from_base[frame - 1]->Between(*drive.odom_from_base[frame]);
}

std::vector<OdometryStep> RunFeatures(const Drive& drive, bool with_wheels) {
  const auto extractor = CreateFeatureExtractor({});
  PlanarOdometry odometry(OptionsFor(drive));
  std::vector<OdometryStep> steps;
  for (std::size_t i = 0; i < drive.images.size(); ++i) {
    const double start = ThreadMs();
    const Features features = extractor->Extract(drive.images[i]);
    const double extracted = ThreadMs();
    const PlanarOdometryResult result =
        odometry.Track(drive.stamp_ns[i], features, with_wheels ? GuessAt(drive, i) : std::nullopt);
    const double tracked = ThreadMs();
    steps.push_back({result.status == PlanarOdometryStatus::kLost, result.odom_from_base, result.chain, result.motion,
                     result.new_keyframe, extracted - start, tracked - extracted});
  }
  return steps;
}

std::vector<OdometryStep> RunKlt(const Drive& drive, bool with_wheels) {
  const auto extractor = CreateFeatureExtractor({});
  KltOdometry odometry(OptionsFor(drive).registration.ScaledTo(drive.camera.floor.resolution_m));
  std::vector<OdometryStep> steps;
  OdometryStep step;
  for (std::size_t i = 0; i < drive.images.size(); ++i) {
    const double start = ThreadMs();
    const cv::Mat gray = extractor->Prepare(drive.images[i]);
    const double prepared = ThreadMs();
    const std::optional<Pose2> motion =
        odometry.Track(gray, drive.images[i], with_wheels ? GuessAt(drive, i) : std::nullopt);
    step.extract_ms = prepared - start;
    step.track_ms = ThreadMs() - prepared;
    step.lost = i > 0 && !motion;
    step.chain += step.lost ? 1 : 0;
    step.odom_from_base = motion ? step.odom_from_base * *motion : step.odom_from_base;
    steps.push_back(step);
  }
  return steps;
}

}  // namespace

std::vector<OdometryMethod> OdometryMethods() {
  return {{"features", [](const Drive& drive) { return RunFeatures(drive, false); }},
          {"features, wheels", [](const Drive& drive) { return RunFeatures(drive, true); }},
          {"KLT", [](const Drive& drive) { return RunKlt(drive, false); }},
          {"KLT, wheels", [](const Drive& drive) { return RunKlt(drive, true); }}};
}

}  // namespace floorloc
