// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/known_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/registration/least_squares.h"

namespace floorloc {
namespace {

// Pairs of points nearer to each other than this share of the extent do not determine a heading.
constexpr double kMinPairShare = 0.2;

// Hypotheses are drawn from at most this many points, evenly spread over the list.
constexpr std::size_t kMaxDrawn = 48;

constexpr int kRefinements = 3;

using Points = std::vector<Eigen::Vector2d>;

double Extent(const Points& points) {
  Eigen::Array2d low = points.front();
  Eigen::Array2d high = low;
  for (const Eigen::Vector2d& p : points) {
    low = low.min(p.array());
    high = high.max(p.array());
  }
  return (high - low).matrix().norm();
}

// The larger of two, the middle of three, the third of four: a bound that most points keep.
double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> Residuals(const Points& local, const Points& known, const Pose2& known_from_local) {
  std::vector<double> residuals;
  for (std::size_t i = 0; i < local.size(); ++i) {
    residuals.push_back((known_from_local * local[i] - known[i]).norm());
  }
  return residuals;
}

Pose2 MotionOfPair(const Points& local, const Points& known, std::size_t i, std::size_t j) {
  const Eigen::Vector2d from = local[j] - local[i];
  const Eigen::Vector2d to = known[j] - known[i];
  const Pose2 turn(0.0, 0.0, std::atan2(to.y(), to.x()) - std::atan2(from.y(), from.x()));
  const Eigen::Vector2d shift = 0.5 * (known[i] + known[j]) - turn * Eigen::Vector2d(0.5 * (local[i] + local[j]));
  return {shift.x(), shift.y(), turn.yaw()};
}

// The motion of two points that leaves the smallest median residual; that of the first when all points coincide.
Pose2 LeastMedian(const Points& local, const Points& known) {
  const double far_m = kMinPairShare * Extent(local);
  const std::size_t stride = (local.size() + kMaxDrawn - 1) / kMaxDrawn;
  std::optional<std::pair<double, Pose2>> best;
  for (std::size_t i = 0; i < local.size(); i += stride) {
    for (std::size_t j = i + stride; j < local.size(); j += stride) {
      if ((local[i] - local[j]).norm() < far_m) {
        continue;
      }
      const Pose2 motion = MotionOfPair(local, known, i, j);
      const double median = Median(Residuals(local, known, motion));
      if (!best || median < best->first) {
        best = {median, motion};
      }
    }
  }
  const Eigen::Vector2d shift = known.front() - local.front();
  return best ? best->second : Pose2(shift.x(), shift.y(), 0.0);
}

// One way to read the coordinates: as metres in a right-handed frame.
struct Reading {
  std::string when;
  Points known_m;
  double scale = 1.0;
  std::vector<double> residuals = {};

  std::size_t CountWithin(double radius_m) const {
    return static_cast<std::size_t>(
        std::count_if(residuals.begin(), residuals.end(), [&](double r) { return r <= radius_m; }));
  }
};

// Least squares over the points that agree.
void Refine(const Points& local, double radius_m, Reading* reading) {
  std::vector<OrientedMatch> pairs;
  for (std::size_t i = 0; i < local.size(); ++i) {
    pairs.push_back({local[i], reading->known_m[i], 0.0, 0.0});
  }
  for (int round = 0; round < kRefinements; ++round) {
    std::vector<int> agreeing;
    for (std::size_t i = 0; i < local.size(); ++i) {
      if (reading->residuals[i] <= radius_m) {
        agreeing.push_back(static_cast<int>(i));
      }
    }
    const auto motion = agreeing.size() > 1 ? FitRigid(pairs, agreeing) : std::nullopt;
    if (!motion) {
      return;
    }
    Reading refined = *reading;
    refined.residuals = Residuals(local, reading->known_m, *motion);
    if (refined.CountWithin(radius_m) < agreeing.size()) {
      return;
    }
    *reading = std::move(refined);
  }
}

// Median ratio of the distances as given to those in the images.
double ScaleOf(const Points& local, const Points& known) {
  const double far_m = kMinPairShare * Extent(local);
  const std::size_t stride = (local.size() + kMaxDrawn - 1) / kMaxDrawn;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < local.size(); i += stride) {
    for (std::size_t j = i + stride; j < local.size(); j += stride) {
      const double distance_m = (local[i] - local[j]).norm();
      if (distance_m >= far_m && distance_m > 0.0) {
        ratios.push_back((known[i] - known[j]).norm() / distance_m);
      }
    }
  }
  return ratios.empty() ? 1.0 : Median(std::move(ratios));
}

std::string Unit(double scale, double tolerance) {
  constexpr std::array<std::pair<double, const char*>, 5> kUnits{
      {{1000.0, "millimetres"}, {100.0, "centimetres"}, {0.001, "kilometres"}, {39.3701, "inches"}, {3.28084, "feet"}}};
  char text[128];
  for (const auto& [units_per_m, name] : kUnits) {
    if (std::abs(std::log(scale / units_per_m)) < std::log(tolerance)) {
      std::snprintf(text, sizeof(text), "divided by %.6g, from %s to metres", units_per_m, name);
      return text;
    }
  }
  std::snprintf(text, sizeof(text), "divided by %.4g (check their unit, and the scale of floor.yaml)", scale);
  return text;
}

Points Mapped(const Points& points, const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& change) {
  Points changed;
  std::transform(points.begin(), points.end(), std::back_inserter(changed), change);
  return changed;
}

// Metres east and north of the first point. Lengths of a degree on WGS 84: series of the U.S. National
// Geospatial-Intelligence Agency, to a millimetre.
Points FromDegrees(const Points& longitude_latitude) {
  const Eigen::Vector2d& first = longitude_latitude.front();
  const double latitude = first.y() * std::numbers::pi / 180.0;
  const double east = 111412.84 * std::cos(latitude) - 93.5 * std::cos(3.0 * latitude);
  const double north = 111132.92 - 559.82 * std::cos(2.0 * latitude) + 1.175 * std::cos(4.0 * latitude);
  return Mapped(longitude_latitude, [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(east * (p.x() - first.x()), north * (p.y() - first.y()));
  });
}

Eigen::Vector2d Swap(const Eigen::Vector2d& p) { return {p.y(), p.x()}; }

// All readings worth trying, the likelier first.
std::vector<Reading> Readings(const Points& local, const Points& known, double max_scale) {
  const char* const mirrored = "x and y are swapped, or one of them has the other sign";
  std::vector<Reading> readings{{"", known}, {mirrored, Mapped(known, Swap)}};
  const double scale = ScaleOf(local, known);
  if (!(scale > 0.0)) {
    return readings;
  }
  constexpr double kDegreesPerM = 1e-4;  // no more, save within a few metres of a pole
  if (scale < kDegreesPerM) {
    const char* const metres = " (give metres of a plane system, such as UTM less an offset)";
    readings.push_back({std::string("x is a longitude and y a latitude, in degrees") + metres, FromDegrees(known)});
    readings.push_back(
        {std::string("x is a latitude and y a longitude, in degrees") + metres, FromDegrees(Mapped(known, Swap))});
  }
  const Points scaled = Mapped(known, [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(p / scale); });
  const bool other_unit = std::abs(std::log(scale)) > std::log(max_scale);
  const std::string unit = other_unit ? Unit(scale, max_scale) : "";
  readings.push_back({unit, scaled, scale});
  readings.push_back({mirrored + (other_unit ? ", and " + unit : ""), Mapped(scaled, Swap), scale});
  return readings;
}

// Bound within which points agree: the best reading's own noise, since long surveys bend.
double AgreementRadius(const std::vector<Reading>& readings, double extent_m, const KnownPointOptions& options) {
  double least = std::numeric_limits<double>::infinity();
  for (const Reading& reading : readings) {
    least = std::min(least, Median(reading.residuals));
  }
  const double bent_m = std::min(options.agree_medians * least, options.agree_share * extent_m);
  return std::max(options.agree_m, bent_m);
}

// The reading that most points agree with, and what that says about the points.
KnownPointFit Judge(const std::vector<Reading>& readings, double radius_m) {
  const auto best = std::max_element(readings.begin(), readings.end(), [&](const Reading& a, const Reading& b) {
    return a.CountWithin(radius_m) < b.CountWithin(radius_m);
  });
  KnownPointFit fit;
  fit.misfit_m = readings.front().residuals;
  fit.scale = best->scale;
  if (2 * best->CountWithin(radius_m) <= fit.misfit_m.size()) {
    fit.status = KnownPointFit::Status::kContradictory;
    return fit;
  }
  if (!best->when.empty()) {
    fit.status = KnownPointFit::Status::kFitsOtherwise;
    fit.when = best->when;
    return fit;
  }
  for (std::size_t i = 0; i < best->residuals.size(); ++i) {
    if (best->residuals[i] > radius_m) {
      fit.disagreeing.push_back(i);
    }
  }
  return fit;
}

}  // namespace

void KnownPointOptions::Check() const {
  RequireOption(agree_m > 0.0, "agree_m must be positive");
  RequireOption(agree_medians >= 1.0, "agree_medians must be 1 or more");
  RequireOption(agree_share >= 0.0 && agree_share < 1.0, "agree_share must be 0 or more and below 1");
  RequireOption(max_scale > 1.0, "max_scale must be above 1");
}

KnownPointFit FitKnownPoints(const std::vector<KnownPoint>& points, const KnownPointOptions& options) {
  options.Check();
  if (points.size() < 2) {
    KnownPointFit fit;
    fit.misfit_m.assign(points.size(), 0.0);
    return fit;
  }
  Points local;
  Points known;
  for (const KnownPoint& point : points) {
    local.push_back(point.local_m);
    known.push_back(point.known_m);
  }
  std::vector<Reading> readings = Readings(local, known, options.max_scale);
  for (Reading& reading : readings) {
    reading.residuals = Residuals(local, reading.known_m, LeastMedian(local, reading.known_m));
  }
  const double radius_m = AgreementRadius(readings, Extent(local), options);
  for (Reading& reading : readings) {
    Refine(local, radius_m, &reading);
  }
  return Judge(readings, radius_m);
}

}  // namespace floorloc
