// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_agreement.h"

#include <cmath>
#include <numbers>

#include "core/io/input_error.h"
#include "core/io/stamp_range.h"
#include "mapbuilder/screening/format_number.h"
#include "mapbuilder/screening/motion_sample.h"
#include "mapbuilder/screening/odometry_reading.h"
#include "mapbuilder/screening/odometry_reading_text.h"

namespace floorloc {
namespace {

constexpr double kWarnScale = 0.03;
constexpr double kRefuseScale = 0.15;
constexpr double kWarnDirectionRad = 3.0 * std::numbers::pi / 180.0;
constexpr double kRefuseDirectionRad = 15.0 * std::numbers::pi / 180.0;
constexpr double kWarnScatter = 0.2;

// Motions that scatter more have no scale and direction to be refused for.
constexpr double kMaxScatter = 0.3;

// The agreement of odometry as it is written.
MotionAgreement CompareSurvey(const FrameSet& set, int survey, const PairRegistrationOptions& registration) {
  const RectM& floor = set.surveys[static_cast<std::size_t>(survey)].survey.camera.floor.roi;
  const MeasuredMotions measured = MeasureMotions(set.frames, survey, floor, registration);
  MotionAgreement agreement = CompareMotions(measured.motions);
  agreement.scale *= measured.unit;
  return agreement;
}

void CountFramesWithOdometry(const std::vector<BuildFrame>& frames, int index, const Survey& survey,
                             std::vector<std::string>* warnings) {
  int all = 0;
  int with = 0;
  for (const BuildFrame& frame : frames) {
    all += frame.survey == index ? 1 : 0;
    with += frame.survey == index && frame.odom_from_base ? 1 : 0;
  }
  const std::string file = (survey.folder / "odometry.tum").string();
  if (all > 0 && with == 0) {
    const auto apart = CompareClocks(StampRange::Of(survey.frames), StampRange::Of(survey.odometry), "odometry");
    throw InputError(
        file, "has no pose at the time of any frame; " +
                  (apart ? apart->sentence + ": " + apart->cure : std::string("check that both use the same clock")) +
                  ", or remove it");
  }
  if (with < all) {
    warnings->push_back(file + ": has no pose at the time of " + std::to_string(all - with) + " of " +
                        std::to_string(all) + " frames");
  }
}

std::string OtherDirection(const MotionAgreement& agreement) {
  return "the images move in a direction turned by " + FormatNumber("%.0f", ToDegrees(agreement.direction_rad)) +
         " degrees against odometry.tum; the homography's axes (x forward, y left) do not fit the robot's";
}

std::string OtherScale(const MotionAgreement& agreement) {
  return "the images show motions " + FormatNumber("%.3g", agreement.scale) +
         " times as long as odometry.tum says; the homography or the odometry has the wrong scale";
}

// What is wrong, and its cure.
std::string Contradiction(const MotionAgreement& agreement) {
  switch (agreement.reading) {
    case OdometryReading::kMirrored:
      return "the images turn right where odometry.tum turns left; the images or the homography are mirrored: switch "
             "off the camera's flip, or calibrate again, or correct odometry's axes";
    case OdometryReading::kAsSaid:
      break;
    default:
      return "the images contradict odometry.tum: correct its axes or units, or remove it";
  }
  return std::abs(agreement.direction_rad) > kRefuseDirectionRad
             ? OtherDirection(agreement) + ": correct the homography, or odometry's axes, or remove odometry.tum"
             : OtherScale(agreement) + ": measure a known length on the floor, or remove odometry.tum";
}

bool IsRefused(const MotionAgreement& agreement) {
  return agreement.reading != OdometryReading::kAsSaid ||
         (agreement.scatter < kMaxScatter && (std::abs(agreement.direction_rad) > kRefuseDirectionRad ||
                                              std::abs(std::log(agreement.scale)) > std::log1p(kRefuseScale)));
}

// The homography may be what is wrong, unless positions and headings of odometry contradict each other.
std::filesystem::path FileToBlame(const MotionAgreement& agreement, const Survey& survey) {
  const bool either = agreement.reading == OdometryReading::kAsSaid || agreement.reading == OdometryReading::kMirrored;
  return survey.folder / (either ? "floor.yaml" : "odometry.tum");
}

void AssessAgreement(const MotionAgreement& agreement, const Survey& survey, std::vector<std::string>* warnings) {
  if (agreement.motions == 0) {
    return;
  }
  if (IsRefused(agreement)) {
    const std::string when = FitsWhen(agreement);
    throw InputError(FileToBlame(agreement, survey),
                     Contradiction(agreement) + (when.empty() ? "" : "; odometry.tum fits when " + when));
  }
  const std::string file = (survey.folder / "floor.yaml").string();
  const bool known = agreement.scatter < kMaxScatter;
  if (known && std::abs(agreement.direction_rad) > kWarnDirectionRad) {
    warnings->push_back(file + ": " + OtherDirection(agreement));
  }
  if (known && std::abs(agreement.scale - 1.0) > kWarnScale) {
    warnings->push_back(file + ": " + OtherScale(agreement));
  }
  if (agreement.scatter > kWarnScatter) {
    warnings->push_back((survey.folder / "odometry.tum").string() + ": differs from the motion in the images by " +
                        FormatNumber("%.0f", 100.0 * agreement.scatter) +
                        " % half of the time; check that both clocks agree");
  }
}

}  // namespace

std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration) {
  std::vector<std::string> warnings;
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    const Survey& survey = set.surveys[s].survey;
    if (survey.odometry.empty()) {
      continue;
    }
    const int index = static_cast<int>(s);
    CountFramesWithOdometry(set.frames, index, survey, &warnings);
    AssessAgreement(CompareSurvey(set, index, registration), survey, &warnings);
  }
  return warnings;
}

}  // namespace floorloc
