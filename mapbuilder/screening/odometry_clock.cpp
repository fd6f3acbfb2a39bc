// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// A motion counts no more than this, in squared sigmas: slips and wrong links are not the clock's.
constexpr double kMaxCost = 16.0;

constexpr double kMedianOfChiSquare = 2.37;  // 3 degrees of freedom

constexpr double kMaxScale = 1.15;  // beyond it odometry is refused
constexpr double kMinLengthM = 0.02;

constexpr std::int64_t kCoarseNs = 25'000'000;
constexpr std::int64_t kFineNs = 1'000'000;

std::int64_t ToNs(double seconds) { return std::llround(1e9 * seconds); }
double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What a delay saves of the squared residuals without it.
struct Gain {
  int count = 0;
  double before = 0.0, sum = 0.0, squares = 0.0;

  void Add(double without, double with) {
    ++count;
    before += without;
    sum += without - with;
    squares += (without - with) * (without - with);
  }
  bool IsCertain(double left, const OdometryClockOptions& options) const {
    return left <= options.max_left * before || sum >= options.min_gain_sigmas * std::sqrt(squares);
  }
};

class DelaySearch {
 public:
  DelaySearch(const std::vector<TimedMotion>& motions, const Trajectory& odometry, const OdometryClockOptions& options)
      : odometry_(odometry), options_(options) {
    // The same motions for every shift: those for which odometry always has an answer.
    const std::int64_t reach_ns = ToNs(options.max_offset_s) + kCoarseNs;
    for (const TimedMotion& motion : motions) {
      if (ByOdometry(motion, reach_ns) && ByOdometry(motion, -reach_ns) && ByOdometry(motion, 0)) {
        motions_.push_back(motion);
      }
    }
  }

  std::optional<std::int64_t> Run() const;

 private:
  // Both motions between two images, odometry's scaled to the images'.
  struct Comparison {
    Pose2 by_odometry;
    double square = 0.0;  // residual against the images, squared sigmas
  };

  std::optional<Pose2> ByOdometry(const TimedMotion& motion, std::int64_t delay_ns) const {
    const auto first = InterpolatePose(odometry_, motion.first_ns - delay_ns);
    const auto second = InterpolatePose(odometry_, motion.second_ns - delay_ns);
    return first && second ? std::optional(first->Between(*second)) : std::nullopt;
  }
  double Square(const Pose2& a, const Pose2& b) const;
  std::vector<Comparison> CompareAt(std::int64_t delay_ns) const;
  double TotalAt(std::int64_t delay_ns) const;
  std::int64_t BestNear(std::int64_t middle_ns, std::int64_t reach_ns, std::int64_t step_ns) const;
  bool IsCertain(std::int64_t delay_ns) const;

  const Trajectory& odometry_;
  const OdometryClockOptions& options_;
  std::vector<TimedMotion> motions_;
};

double DelaySearch::Square(const Pose2& a, const Pose2& b) const {
  const double sigma_m = options_.sigma_m + options_.sigma_share * b.translation().norm();
  const double sigma_rad = options_.sigma_rad + options_.sigma_share * std::abs(b.yaw());
  const double turn = WrapAngle(a.yaw() - b.yaw()) / sigma_rad;
  return (a.translation() - b.translation()).squaredNorm() / (sigma_m * sigma_m) + turn * turn;
}

std::vector<DelaySearch::Comparison> DelaySearch::CompareAt(std::int64_t delay_ns) const {
  std::vector<Comparison> all;
  std::vector<double> scales{1.0};
  for (const TimedMotion& motion : motions_) {
    const Pose2 said = ByOdometry(motion, delay_ns).value_or(Pose2());
    all.push_back({said, 0.0});
    if (said.translation().norm() > kMinLengthM) {
      scales.push_back(motion.first_from_second.translation().norm() / said.translation().norm());
    }
  }
  const double scale = std::clamp(Median(std::move(scales)), 1.0 / kMaxScale, kMaxScale);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Pose2& said = all[i].by_odometry;
    all[i].by_odometry = Pose2(scale * said.x(), scale * said.y(), said.yaw());
    all[i].square = Square(all[i].by_odometry, motions_[i].first_from_second);
  }
  return all;
}

double DelaySearch::TotalAt(std::int64_t delay_ns) const {
  double total = 0.0;
  for (const Comparison& comparison : CompareAt(delay_ns)) {
    total += std::min(comparison.square, kMaxCost);
  }
  return total;
}

std::int64_t DelaySearch::BestNear(std::int64_t middle_ns, std::int64_t reach_ns, std::int64_t step_ns) const {
  std::int64_t best_ns = middle_ns;
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t delay_ns = middle_ns - reach_ns; delay_ns <= middle_ns + reach_ns; delay_ns += step_ns) {
    const double total = TotalAt(delay_ns);
    if (total < least) {
      least = total;
      best_ns = delay_ns;
    }
  }
  return best_ns;
}

// Looks only at the motions that the delay changes by more than their scatter.
bool DelaySearch::IsCertain(std::int64_t delay_ns) const {
  const std::vector<Comparison> without = CompareAt(0);
  const std::vector<Comparison> with = CompareAt(delay_ns);
  const std::vector<Comparison> opposite = CompareAt(-delay_ns);
  std::vector<double> squares;
  for (const Comparison& comparison : with) {
    squares.push_back(comparison.square);
  }
  const double variance = std::max(1.0, Median(std::move(squares)) / kMedianOfChiSquare);
  const auto cost = [&](const Comparison& comparison) { return std::min(comparison.square / variance, kMaxCost); };
  double left = 0.0;
  Gain against_none, against_opposite;
  for (std::size_t i = 0; i < with.size(); ++i) {
    if (Square(with[i].by_odometry, without[i].by_odometry) > options_.min_change * variance) {
      left += cost(with[i]);
      against_none.Add(cost(without[i]), cost(with[i]));
      against_opposite.Add(cost(opposite[i]), cost(with[i]));
    }
  }
  return against_none.count >= options_.min_telling && against_none.IsCertain(left, options_) &&
         against_opposite.IsCertain(left, options_);
}

std::optional<std::int64_t> DelaySearch::Run() const {
  if (static_cast<int>(motions_.size()) < options_.min_telling) {
    return std::nullopt;
  }
  const std::int64_t coarse_ns = BestNear(0, ToNs(options_.max_offset_s), kCoarseNs);
  const std::int64_t best_ns = BestNear(coarse_ns, kCoarseNs, kFineNs);
  const bool matters = std::abs(best_ns) >= ToNs(options_.min_offset_s);
  return matters && IsCertain(best_ns) ? std::optional(best_ns) : std::nullopt;
}

// How much odometry's motion between two frames depends on the clock.
double ChangeWithClock(const FramePair& pair, const std::vector<BuildFrame>& frames, const Trajectory& odometry) {
  constexpr std::int64_t kShiftNs = 200'000'000;
  const auto moved = [&](std::int64_t shift_ns) {
    const auto first = InterpolatePose(odometry, frames[static_cast<std::size_t>(pair.first)].info.stamp_ns + shift_ns);
    const auto second =
        InterpolatePose(odometry, frames[static_cast<std::size_t>(pair.second)].info.stamp_ns + shift_ns);
    return first && second ? first->Between(*second) : Pose2();
  };
  const Pose2 change = moved(-kShiftNs).Between(moved(kShiftNs));
  return change.translation().norm() + std::abs(change.yaw());
}

// Neighbours in time of a survey: where odometry changes most, and others spread evenly.
std::vector<FramePair> ChoosePairs(const FrameSet& set, int survey, int count) {
  std::vector<FramePair> pairs = SelectConsecutivePairs(set.frames);
  std::erase_if(pairs, [&](const FramePair& pair) {
    return set.frames[static_cast<std::size_t>(pair.first)].survey != survey || !pair.first_from_second;
  });
  if (static_cast<int>(pairs.size()) <= count) {
    return pairs;
  }
  const Trajectory& odometry = set.surveys[static_cast<std::size_t>(survey)].survey.odometry;
  std::vector<std::pair<double, std::size_t>> by_change;
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    by_change.emplace_back(-ChangeWithClock(pairs[i], set.frames, odometry), i);
  }
  std::sort(by_change.begin(), by_change.end());
  const std::size_t half = static_cast<std::size_t>(count) / 2;
  for (std::size_t k = 0; k < half; ++k) {
    chosen.insert(by_change[k].second);
    chosen.insert(k * pairs.size() / half);
  }
  std::vector<FramePair> some;
  for (const std::size_t i : chosen) {
    some.push_back(pairs[i]);
  }
  return some;
}

// Motions between the pairs by their images: around odometry's motion, or else anywhere.
std::vector<TimedMotion> MotionsOf(const FrameSet& set, std::vector<FramePair> pairs,
                                   PairRegistrationOptions registration) {
  registration.run.progress = {};
  const std::vector<RectM> floors = set.FloorsInBase();
  std::vector<Link> links = RegisterPairs(set.frames, floors, pairs, registration);
  std::set<int> found;
  for (const Link& link : links) {
    found.insert(link.first);
  }
  std::erase_if(pairs, [&](const FramePair& pair) { return found.contains(pair.first); });
  for (FramePair& pair : pairs) {
    pair.first_from_second.reset();
  }
  const std::vector<Link> anywhere = RegisterPairs(set.frames, floors, pairs, registration);
  links.insert(links.end(), anywhere.begin(), anywhere.end());
  std::vector<TimedMotion> motions;
  for (const Link& link : links) {
    motions.push_back({set.frames[static_cast<std::size_t>(link.first)].info.stamp_ns,
                       set.frames[static_cast<std::size_t>(link.second)].info.stamp_ns, link.first_from_second});
  }
  return motions;
}

std::string Sentence(std::int64_t delay_ns, const Survey& survey) {
  const char* const format =
      delay_ns > 0
          ? ": images are stamped %.0f ms late against it; compensated: stamp images when they are exposed, not when "
            "they arrive"
          : ": its poses are stamped %.0f ms late against the images; compensated: stamp odometry when the wheels are "
            "read, not when it is sent";
  char text[256];
  std::snprintf(text, sizeof(text), format, 1e-6 * std::abs(static_cast<double>(delay_ns)));
  return (survey.folder / "odometry.tum").string() + text;
}

// Odometry on the images' clock.
void Delay(std::int64_t delay_ns, int survey, FrameSet* set) {
  Trajectory& odometry = set->surveys[static_cast<std::size_t>(survey)].survey.odometry;
  for (StampedPose3& row : odometry) {
    row.stamp_ns += delay_ns;
  }
  for (BuildFrame& frame : set->frames) {
    if (frame.survey == survey) {
      frame.odom_from_base = InterpolatePose(odometry, frame.info.stamp_ns);
    }
  }
}

}  // namespace

void OdometryClockOptions::Check() const {
  RequireOption(max_offset_s > 0.0 && max_offset_s <= 10.0, "max_offset_s must be above 0 and at most 10");
  RequireOption(min_offset_s > 0.0, "min_offset_s must be positive");
  RequireOption(max_motions >= 2, "max_motions must be 2 or more");
  RequireOption(sigma_m > 0.0, "sigma_m must be positive");
  RequireOption(sigma_rad > 0.0, "sigma_rad must be positive");
  RequireOption(sigma_share >= 0.0, "sigma_share must not be negative");
  RequireOption(min_change > 0.0, "min_change must be positive");
  RequireOption(min_telling >= 1, "min_telling must be 1 or more");
  RequireOption(min_gain_sigmas > 0.0, "min_gain_sigmas must be positive");
  RequireOption(max_left > 0.0 && max_left < 1.0, "max_left must be between 0 and 1");
}

std::optional<std::int64_t> FindImageDelayNs(const std::vector<TimedMotion>& motions, const Trajectory& odometry,
                                             const OdometryClockOptions& options) {
  options.Check();
  return DelaySearch(motions, odometry, options).Run();
}

std::vector<std::string> MendOdometryClock(const PairRegistrationOptions& registration,
                                           const OdometryClockOptions& options, FrameSet* set) {
  options.Check();
  std::vector<std::string> sentences;
  for (std::size_t s = 0; s < set->surveys.size(); ++s) {
    const Survey& survey = set->surveys[s].survey;
    if (survey.odometry.empty()) {
      continue;
    }
    const int index = static_cast<int>(s);
    const std::vector<TimedMotion> motions =
        MotionsOf(*set, ChoosePairs(*set, index, options.max_motions), registration);
    if (const auto delay_ns = FindImageDelayNs(motions, survey.odometry, options)) {
      sentences.push_back(Sentence(*delay_ns, survey));
      Delay(*delay_ns, index, set);
    }
  }
  return sentences;
}

}  // namespace floorloc
