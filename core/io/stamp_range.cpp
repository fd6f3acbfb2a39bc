// SPDX-License-Identifier: Apache-2.0
#include "core/io/stamp_range.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "core/io/delimited_text.h"
#include "core/io/trajectory.h"

namespace floorloc {
namespace {

constexpr double kUnixTimeS = 1e9;  // 2001: clocks that count since they were started are below
constexpr double kHalfHourS = 1800.0;
constexpr double kMaxZoneS = 14.0 * 3600.0;
constexpr double kSameDriveS = 30.0;  // two recorders of a drive start within this

struct Unit {
  double per_second;
  const char* name;
};
constexpr std::array<Unit, 3> kUnits{{{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};

double MiddleS(const StampRange& range) { return 0.5 * (ToSeconds(range.first_ns) + ToSeconds(range.last_ns)); }

// The unit in which the larger time counts if the smaller one is in seconds.
const Unit* UnitBetween(double small_s, double large_s, double tolerance) {
  for (const Unit& unit : kUnits) {
    if (small_s > 0.0 && std::abs(large_s / small_s / unit.per_second - 1.0) < tolerance) {
      return &unit;
    }
  }
  return nullptr;
}

// A cure, and whether it is for another unit or epoch. Stamps of Unix time tell a factor precisely, those since a start
// only as well as both started together.
std::pair<std::string, bool> Cure(double images_s, double other_s, const std::string& name) {
  const bool images_unix = images_s > kUnixTimeS;
  const bool other_unix = other_s > kUnixTimeS;
  const std::string images = "the images";
  const bool images_larger = images_s > other_s;
  constexpr double kPrecise = 0.01, kCoarse = 0.2;
  const Unit* unit = UnitBetween(std::min(images_s, other_s), std::max(images_s, other_s),
                                 images_unix || other_unix ? kPrecise : kCoarse);
  if (unit != nullptr) {
    return {"stamps of " + (images_larger ? images : name) + " are to those of " + (images_larger ? name : images) +
                " as " + unit->name + " are to seconds: give both in seconds",
            true};
  }
  if (images_unix != other_unix) {
    return {"stamps of " + (images_unix ? images : name) + " are Unix time, those of " + (images_unix ? name : images) +
                " count since something was started (uptime, simulation): stamp both by one clock, such as ROS time",
            true};
  }
  const double apart_s = std::abs(images_s - other_s);
  const double half_hours = std::round(apart_s / kHalfHourS);
  if (images_unix && half_hours >= 1.0 && apart_s < kMaxZoneS &&
      std::abs(apart_s - half_hours * kHalfHourS) < kSameDriveS) {
    char text[128];
    std::snprintf(text, sizeof(text), "they are %.1f h apart, as by a time zone: stamp both in UTC",
                  half_hours * kHalfHourS / 3600.0);
    return {text, false};
  }
  return {"give both the same clock", false};
}

}  // namespace

std::optional<ForeignClocks> CompareClocks(const StampRange& images, const StampRange& other, const std::string& name,
                                           double tolerance_s) {
  const double before_s = ToSeconds(images.first_ns) - ToSeconds(other.last_ns);
  const double after_s = ToSeconds(other.first_ns) - ToSeconds(images.last_ns);
  if (before_s <= tolerance_s && after_s <= tolerance_s) {
    return std::nullopt;
  }
  char ranges[256];
  std::snprintf(ranges, sizeof(ranges), "images are stamped from %.1f to %.1f s, %s from %.1f to %.1f s",
                ToSeconds(images.first_ns), ToSeconds(images.last_ns), name.c_str(), ToSeconds(other.first_ns),
                ToSeconds(other.last_ns));
  const auto [cure, of_other_scale] = Cure(MiddleS(images), MiddleS(other), name);
  return ForeignClocks{ranges, cure, of_other_scale};
}

std::optional<std::string> HintAboutUnit(std::string_view stamp) {
  const std::optional<double> number = ParseNumber(stamp);
  for (const Unit& unit : kUnits) {
    const double seconds = number ? std::abs(*number) / unit.per_second : 0.0;
    if (seconds > kUnixTimeS && seconds < 4.0 * kUnixTimeS) {
      char text[128];
      std::snprintf(text, sizeof(text), "it looks like %s since 1970: divide by %.0f", unit.name, unit.per_second);
      return text;
    }
  }
  return std::nullopt;
}

}  // namespace floorloc
