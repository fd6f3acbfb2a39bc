// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_reading.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

using Complex = std::complex<double>;

constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

// A motion counts no more than this, in squared sigmas: slips and wrong links say nothing of how odometry is written.
constexpr double kMaxCost = 16.0;

constexpr double kMedianOfChiSquare = 2.37;  // 3 degrees of freedom

// Odometry that stands still while the median motion is this many times as long has no direction.
constexpr double kMinShareOfMedian = 0.1;

// A motion that is not most of the way between its frames is one between two lanes, which drift has turned.
constexpr double kMinDirectShare = 0.7;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Complex Translation(const Pose2& motion) { return {motion.x(), motion.y()}; }

// The motion that odometry tells under a reading.
Pose2 Read(const MotionPair& m, OdometryReading reading) {
  const bool positions = reading == OdometryReading::kMirrored || reading == OdometryReading::kPositionsMirrored;
  const bool headings = reading == OdometryReading::kMirrored || reading == OdometryReading::kHeadingsMirrored;
  const Complex in_odom = Translation(m.by_odometry) * std::polar(1.0, m.heading_rad);
  const Complex way =
      (positions ? std::conj(in_odom) : in_odom) * std::polar(1.0, headings ? m.heading_rad : -m.heading_rad);
  return {way.real(), way.imag(), headings ? -m.by_odometry.yaw() : m.by_odometry.yaw()};
}

// by_vision = factor * by_odometry
struct Fit {
  int motions = 0;
  Complex factor{1.0, 0.0};
  double scatter = 0.0;  // median residual, share of the motion
};

struct ReadMotion {
  Pose2 motion;
  const MotionPair* pair;
};

std::vector<ReadMotion> ReadAll(const std::vector<MotionPair>& motions, OdometryReading reading) {
  std::vector<ReadMotion> read;
  for (const MotionPair& m : motions) {
    read.push_back({Read(m, reading), &m});
  }
  return read;
}

// The motions that determine scale and direction.
std::vector<ReadMotion> StraightMotions(std::vector<ReadMotion> read, const OdometryReadingOptions& options) {
  std::erase_if(read, [&](const ReadMotion& r) {
    return r.pair->by_vision.translation().norm() < options.min_length_m ||
           std::abs(r.pair->by_vision.yaw()) > options.max_turn_rad ||
           r.motion.translation().norm() < kMinDirectShare * r.pair->travelled_m;
  });
  std::vector<double> lengths{0.0};
  for (const ReadMotion& r : read) {
    lengths.push_back(r.motion.translation().norm());
  }
  const double shortest_m = std::max(1e-9, kMinShareOfMedian * Median(std::move(lengths)));
  std::erase_if(read, [&](const ReadMotion& r) { return r.motion.translation().norm() < shortest_m; });
  return read;
}

Fit FitFactor(const std::vector<ReadMotion>& straight) {
  Fit fit;
  fit.motions = static_cast<int>(straight.size());
  if (straight.empty()) {
    return fit;
  }
  std::vector<double> re, im, left;
  for (const ReadMotion& r : straight) {
    const Complex ratio = Translation(r.pair->by_vision) / Translation(r.motion);
    re.push_back(ratio.real());
    im.push_back(ratio.imag());
  }
  fit.factor = {Median(std::move(re)), Median(std::move(im))};
  for (const ReadMotion& r : straight) {
    const Complex seen = Translation(r.pair->by_vision);
    left.push_back(std::abs(seen - fit.factor * Translation(r.motion)) / std::abs(seen));
  }
  fit.scatter = Median(std::move(left));
  return fit;
}

// Squared residuals of the motions by vision against what a reading predicts, in squared sigmas.
class Prediction {
 public:
  Prediction(const std::vector<MotionPair>& motions, OdometryReading reading, const OdometryReadingOptions& options)
      : options_(options), reading_(reading), read_(ReadAll(motions, reading)) {
    fit_ = FitFactor(StraightMotions(read_, options));
    for (ReadMotion& r : read_) {
      const Complex way = fit_.factor * Translation(r.motion);
      r.motion = Pose2(way.real(), way.imag(), r.motion.yaw());
      squares_.push_back(Square(r, r.pair->by_vision));
    }
  }

  OdometryReading reading() const { return reading_; }
  const Fit& fit() const { return fit_; }
  const std::vector<double>& squares() const { return squares_; }
  double Change(const Prediction& other, std::size_t i) const { return Square(read_[i], other.read_[i].motion); }
  double Variance() const { return std::max(1.0, Median(squares_) / kMedianOfChiSquare); }

 private:
  double Square(const ReadMotion& r, const Pose2& other) const {
    const Pose2& seen = r.pair->by_vision;
    const double way_m = std::max(std::abs(fit_.factor) * r.pair->travelled_m, seen.translation().norm());
    const double sigma_m = options_.sigma_m + options_.sigma_share * seen.translation().norm() +
                           options_.drift_share * way_m + options_.lever_m * 2.0 * std::abs(std::sin(0.5 * seen.yaw()));
    const double sigma_rad =
        options_.sigma_rad + options_.sigma_share * std::abs(seen.yaw()) + options_.drift_rad_per_m * way_m;
    const double turn = WrapAngle(r.motion.yaw() - other.yaw()) / sigma_rad;
    return (r.motion.translation() - other.translation()).squaredNorm() / (sigma_m * sigma_m) + turn * turn;
  }

  const OdometryReadingOptions& options_;
  OdometryReading reading_;
  std::vector<ReadMotion> read_;
  Fit fit_;
  std::vector<double> squares_;
};

// How many squared residuals there are without a reading and with it, of the motions that tell.
struct Comparison {
  int telling = 0;
  double without = 0.0, with = 0.0;

  void Add(double square_without, double square_with, double variance) {
    ++telling;
    without += std::min(square_without / variance, kMaxCost);
    with += std::min(square_with / variance, kMaxCost);
  }
  bool IsCertain(const OdometryReadingOptions& options) const {
    return telling >= options.min_telling && with <= options.max_left * without;
  }
  double Gain() const { return without - with; }
};

Comparison Compare(const Prediction& as_said, const Prediction& other, const OdometryReadingOptions& options) {
  const double variance = other.Variance();
  Comparison comparison;
  for (std::size_t i = 0; i < other.squares().size(); ++i) {
    if (other.Change(as_said, i) > options.min_change * variance) {
      comparison.Add(as_said.squares()[i], other.squares()[i], variance);
    }
  }
  return comparison;
}

// Headings of another unit: where the robot drove straight positions are as they were, so that only turns tell.
bool TurnsAre(double times, const std::vector<MotionPair>& motions, const OdometryReadingOptions& options) {
  std::vector<double> without, with;
  Comparison comparison;
  for (const MotionPair& m : motions) {
    const double seen = m.by_vision.yaw();
    const double sigma_rad = options.sigma_rad + options.sigma_share * std::abs(seen) +
                             options.drift_rad_per_m * std::max(m.travelled_m, m.by_vision.translation().norm());
    const auto square = [&](double factor) {
      const double off = WrapAngle(m.by_odometry.yaw() - factor * seen) / (std::max(1.0, factor) * sigma_rad);
      return off * off;
    };
    const double change = WrapAngle((times - 1.0) * seen) / (std::max(1.0, times) * sigma_rad);
    if (change * change > options.min_change) {
      comparison.Add(square(1.0), square(times), 1.0);
    }
  }
  return comparison.IsCertain(options);
}

}  // namespace

void OdometryReadingOptions::Check() const {
  RequireOption(sigma_m > 0.0, "sigma_m must be positive");
  RequireOption(sigma_rad > 0.0, "sigma_rad must be positive");
  RequireOption(sigma_share >= 0.0, "sigma_share must not be negative");
  RequireOption(drift_share >= 0.0, "drift_share must not be negative");
  RequireOption(drift_rad_per_m >= 0.0, "drift_rad_per_m must not be negative");
  RequireOption(lever_m >= 0.0, "lever_m must not be negative");
  RequireOption(min_length_m > 0.0, "min_length_m must be positive");
  RequireOption(max_turn_rad > 0.0, "max_turn_rad must be positive");
  RequireOption(min_change > 0.0, "min_change must be positive");
  RequireOption(min_telling >= 1, "min_telling must be 1 or more");
  RequireOption(max_left > 0.0 && max_left < 1.0, "max_left must be between 0 and 1");
}

MotionAgreement CompareMotions(const std::vector<MotionPair>& motions, const OdometryReadingOptions& options) {
  options.Check();
  const Prediction as_said(motions, OdometryReading::kAsSaid, options);
  if (as_said.fit().motions < options.min_telling) {
    return {};
  }
  const auto agreement = [](const Fit& fit, OdometryReading reading) {
    return MotionAgreement{fit.motions, reading, std::abs(fit.factor), std::arg(fit.factor), fit.scatter};
  };
  if (TurnsAre(kDegreesPerRad, motions, options)) {
    return agreement(as_said.fit(), OdometryReading::kDegrees);
  }
  if (TurnsAre(1.0 / kDegreesPerRad, motions, options)) {
    return agreement(as_said.fit(), OdometryReading::kStandingHeadings);
  }
  MotionAgreement best = agreement(as_said.fit(), OdometryReading::kAsSaid);
  double most = 0.0;
  for (const OdometryReading reading :
       {OdometryReading::kMirrored, OdometryReading::kPositionsMirrored, OdometryReading::kHeadingsMirrored}) {
    const Prediction other(motions, reading, options);
    const Comparison comparison = Compare(as_said, other, options);
    if (comparison.IsCertain(options) && comparison.Gain() > most) {
      most = comparison.Gain();
      best = agreement(other.fit(), reading);
    }
  }
  return best;
}

}  // namespace floorloc
