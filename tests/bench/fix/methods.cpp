// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fix/methods.h"

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Times of every stage, one per frame.
struct StageSamples {
  std::vector<double> decode_ms, rectify_ms, features_ms, match_ms, register_ms;

  void Add(double decode, const LocalizationTiming& timing) {
    decode_ms.push_back(decode);
    rectify_ms.push_back(timing.rectify_ms);
    features_ms.push_back(timing.features_ms);
    match_ms.push_back(timing.match_ms);
    register_ms.push_back(timing.register_ms);
  }

  StageTimes Medians() const {
    return {Percentile(decode_ms, 0.5), Percentile(rectify_ms, 0.5), Percentile(features_ms, 0.5),
            Percentile(match_ms, 0.5), Percentile(register_ms, 0.5)};
  }
};

}  // namespace

Priors NoPriors(std::size_t frames) { return Priors(frames); }

Priors PerturbedPriors(const std::vector<Pose2>& truth_from_base, const Pose2& truth_from_map) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-0.1, 0.1);
  Priors priors;
  for (const Pose2& pose : truth_from_base) {
    const double x = offset(random), y = offset(random), yaw = offset(random);
    const Pose2 map_from_base = truth_from_map.Inverse() * pose;
    PosePrior prior;
    prior.map_from_base = Pose2(map_from_base.x() + x, map_from_base.y() + y, map_from_base.yaw() + yaw);
    priors.emplace_back(prior);
  }
  return priors;
}

MethodRun RunLocalizer(const Localizer& localizer, const BenchFrames& frames, const Priors& priors) {
  MethodRun run;
  StageSamples samples;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Clock::time_point start = Clock::now();
    const cv::Mat raw = frames.Decode(i);
    const double decode_ms = MillisecondsSince(start);
    const LocalizationResult result = localizer.Localize(frames.rectifier, raw, priors[i]);
    Fix fix;
    fix.total_ms = MillisecondsSince(start);
    if (result.status == LocalizationStatus::kLocalized) {
      fix.map_from_base = result.map_from_base;
    }
    run.fixes.push_back(fix);
    samples.Add(decode_ms, result.timing);
  }
  run.stages = samples.Medians();
  return run;
}

MethodRun RunBaseline(const Baseline& baseline, const BenchFrames& frames) {
  MethodRun run;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Clock::time_point start = Clock::now();
    Fix fix;
    fix.map_from_base = baseline.Locate(frames.rectifier.Rectify(frames.Decode(i)));
    fix.total_ms = MillisecondsSince(start);
    run.fixes.push_back(fix);
  }
  return run;
}

double MeasureFixesPerSecond(const Localizer& localizer, const BenchFrames& frames, const Priors& priors, int threads) {
  const Clock::time_point start = Clock::now();
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    while (MillisecondsSince(start) < 2000.0) {
      const std::size_t frame = next++ % frames.size();
      localizer.Localize(frames.rectifier, frames.Decode(frame), priors[frame]);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back(work);
    }
  }
  return 1000.0 * static_cast<double>(next) / MillisecondsSince(start);
}

}  // namespace floorloc
