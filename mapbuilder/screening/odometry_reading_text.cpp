// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_reading_text.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "mapbuilder/screening/format_number.h"

namespace floorloc {
namespace {

bool IsNear(double angle_rad, double degrees) {
  constexpr double kNear = 15.0;
  return std::abs(ToDegrees(WrapAngle(angle_rad - degrees * std::numbers::pi / 180.0))) < kNear;
}

std::string WhenTurned(double direction_rad) {
  if (IsNear(direction_rad, 0.0)) {
    return "";
  }
  std::string text = FormatNumber("its motions are turned by %.0f degrees", ToDegrees(direction_rad));
  if (IsNear(direction_rad, 180.0)) {
    return text + " (it says backward where the robot drives forward)";
  }
  if (IsNear(direction_rad, 90.0) || IsNear(direction_rad, -90.0)) {
    return text + " (it says " + (direction_rad > 0.0 ? "right" : "left") +
           " where the robot drives forward: x and y of its axes are exchanged)";
  }
  return text;
}

std::string WhenRead(const MotionAgreement& agreement) {
  const double direction_rad = agreement.direction_rad;
  std::string turned = WhenTurned(direction_rad);
  const std::string also = turned.empty() ? "" : " and " + turned;
  switch (agreement.reading) {
    case OdometryReading::kAsSaid:
      return turned;
    case OdometryReading::kMirrored:
      return "its y and its headings are negated (seen from above y points to the left of x)" + also;
    case OdometryReading::kPositionsMirrored:
      return IsNear(direction_rad, 0.0)                                    ? "y of its positions is negated"
             : IsNear(direction_rad, 180.0)                                ? "x of its positions is negated"
             : IsNear(direction_rad, 90.0) || IsNear(direction_rad, -90.0) ? "x and y of its positions are exchanged"
                                                                           : "y of its positions is negated" + also;
    case OdometryReading::kHeadingsMirrored:
      return "its headings are negated (they count counter-clockwise)" + also;
    case OdometryReading::kDegrees:
      return "its headings are degrees, not radians";
    case OdometryReading::kStandingHeadings:
      return "its headings turn as the images do (they stand still, or are radians written as if they were degrees)";
  }
  return "";
}

std::string WhenScaled(double scale) {
  constexpr double kNear = 0.1;
  constexpr std::array<std::pair<double, const char*>, 5> kUnits{
      {{1e-3, "millimetres"}, {1e-2, "centimetres"}, {0.0254, "inches"}, {0.3048, "feet"}, {1e3, "kilometres"}}};
  for (const auto& [metres, name] : kUnits) {
    if (std::abs(std::log(scale / metres)) < kNear) {
      return std::string("its positions are ") + name + ", not metres";
    }
  }
  return std::abs(std::log(scale)) < kNear ? "" : FormatNumber("its positions are multiplied by %.3g", scale);
}

}  // namespace

std::string FitsWhen(const MotionAgreement& agreement) {
  const std::string read = WhenRead(agreement);
  // Without headings there is no direction, and so no fit of the scale.
  const bool no_headings =
      agreement.reading == OdometryReading::kDegrees || agreement.reading == OdometryReading::kStandingHeadings;
  const std::string scaled = no_headings || agreement.motions == 0 ? "" : WhenScaled(agreement.scale);
  return read + (read.empty() || scaled.empty() ? "" : " and ") + scaled;
}

}  // namespace floorloc
