// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <numbers>

#include "core/diagnosis/part_findings.h"
#include "core/io/trajectory.h"

namespace floorloc {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// value at a share of the sorted list, which must not be empty
double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto index = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(index, values.size() - 1)];
}

// Seconds from an image to the next one, where they follow each other.
std::optional<double> SecondsBetween(const RecordedFrame& before, const RecordedFrame& after, double max_s) {
  const double seconds = ToSeconds(after.stamp_ns - before.stamp_ns);
  return seconds > 0.0 && seconds <= max_s ? std::optional(seconds) : std::nullopt;
}

double DistanceM(const Pose2& from, const Pose2& to) { return from.Between(to).translation().norm(); }

// True when the images that are not found are those that were taken fast.
bool IsLostBySpeed(const DriveRecord& record, const DiagnosisOptions& options) {
  std::vector<double> found_m_s, lost_m_s;
  for (std::size_t i = 1; i < record.frames().size(); ++i) {
    const RecordedFrame& before = record.frames()[i - 1];
    const RecordedFrame& after = record.frames()[i];
    const std::optional<double> seconds = SecondsBetween(before, after, options.max_pair_s);
    if (seconds && before.odom_from_base && after.odom_from_base) {
      (after.IsLocalized() ? found_m_s : lost_m_s)
          .push_back(DistanceM(*before.odom_from_base, *after.odom_from_base) / *seconds);
    }
  }
  if (static_cast<int>(std::min(found_m_s.size(), lost_m_s.size())) < options.min_images / 2) {
    return false;
  }
  constexpr double kSlowMps = 0.1;  // at standstill every speed is many times the other one
  const double lost = Quantile(lost_m_s, 0.5);
  return lost > kSlowMps && lost > options.blur_speed_ratio * Quantile(found_m_s, 0.5);
}

// Why images are not found, by the reason that is the most frequent.
std::string CureOfLost(const DriveRecord& record, const DiagnosisOptions& options) {
  constexpr auto kReasons = static_cast<std::size_t>(NotLocalizedReason::kOtherFloor) + 1;
  std::array<int, kReasons> reasons{};
  int ambiguous = 0, lost = 0;
  for (const RecordedFrame& frame : record.frames()) {
    lost += frame.IsLocalized() ? 0 : 1;
    ambiguous += frame.status == LocalizationStatus::kAmbiguous ? 1 : 0;
    reasons.at(static_cast<std::size_t>(frame.reason)) += frame.status == LocalizationStatus::kNotLocalized ? 1 : 0;
  }
  if (2 * ambiguous > lost) {
    return "several places of the floor look alike: set the pose at the start, or use a part of the floor that differs";
  }
  if (IsLostBySpeed(record, options)) {
    return "those that are not found were taken when driving fast, so they are blurred: shorten the exposure, add "
           "light, "
           "or drive more slowly";
  }
  const auto most = std::max_element(reasons.begin(), reasons.end()) - reasons.begin();
  switch (static_cast<NotLocalizedReason>(most)) {
    case NotLocalizedReason::kTooFewKeypoints:
      return "they show too little structure: see whether they are dark, overexposed, blurred or dirty";
    case NotLocalizedReason::kViewDisagrees:
      return "they agree with the map in a part of the view only: mask what is no floor, or survey the floor again "
             "where "
             "it changed";
    case NotLocalizedReason::kNoFloor:
      return "they show no floor: see whether something is before the camera, it is dark, or a lamp blinds it";
    case NotLocalizedReason::kOtherFloor:
      return "they show a floor that looks different from the map's: see whether the map is that of this floor, and "
             "survey what was not";
    default:
      return "they do not match the map: see whether it is another floor, the floor is worn or changed, or the "
             "camera's "
             "calibration and mounting are those of another camera";
  }
}

}  // namespace

Finding FindingOfFloor(const DriveRecord& record, const DiagnosisOptions& options) {
  const std::size_t images = record.frames().size();
  const auto localized = std::count_if(record.frames().begin(), record.frames().end(),
                                       [](const RecordedFrame& frame) { return frame.IsLocalized(); });
  const std::string sentence = FormatSentence("%td of %zu images were found in the map", localized, images);
  if (images < static_cast<std::size_t>(options.min_images)) {
    return {"floor", FindingStatus::kUnknown, sentence + ", which are too few to tell", "drive on"};
  }
  const double share = static_cast<double>(localized) / static_cast<double>(images);
  if (share >= options.min_localized_share) {
    return {"floor", FindingStatus::kOk, sentence, ""};
  }
  return {"floor", share < options.lost_localized_share ? FindingStatus::kWrong : FindingStatus::kNote, sentence,
          CureOfLost(record, options)};
}

Finding FindingOfImages(const DriveRecord& record, double view_m, const DiagnosisOptions& options) {
  std::vector<double> steps_m, steps_s;
  for (std::size_t i = 1; i < record.frames().size(); ++i) {
    const RecordedFrame& before = record.frames()[i - 1];
    const RecordedFrame& after = record.frames()[i];
    const std::optional<double> seconds = SecondsBetween(before, after, options.max_pair_s);
    if (before.IsLocalized() && after.IsLocalized() && seconds) {
      steps_m.push_back(DistanceM(before.map_from_base, after.map_from_base));
      steps_s.push_back(*seconds);
    }
  }
  if (steps_m.empty()) {
    return {"images", FindingStatus::kUnknown, "no two images in a row were found: their distance is unknown", ""};
  }
  const double step_m = Quantile(steps_m, 0.9);
  const std::string sentence =
      FormatSentence("images are up to %.2f m apart (90 %%) at %.1f per second, a view is %.2f m wide", step_m,
                     1.0 / Quantile(steps_s, 0.5), view_m);
  const std::optional<OdometryTrust>& wheels = record.frames().back().odometry;
  const bool trusted = wheels && wheels->health == OdometryHealth::kOk;
  if (step_m <= options.max_step_share * view_m) {
    return {"images", FindingStatus::kOk, sentence, ""};
  }
  if (trusted) {
    return {"images", FindingStatus::kOk, sentence + ": the motion between them is that of the odometry", ""};
  }
  return {"images", FindingStatus::kNote, sentence + ": the motion between images can't be seen",
          "take them more often, or drive more slowly, as long as there is no odometry that agrees with them"};
}

Finding FindingOfCamera(const ObservedCamera& camera) {
  const CameraErrors& e = camera.estimate.errors.mean;
  const std::string errors =
      FormatSentence("roll %+.2f, pitch %+.2f degrees, height %+.1f %%, floor points off by up to %.1f px",
                     kDegrees * e(0), kDegrees * e(1), 100.0 * e(2), camera.off_px);
  switch (camera.estimate.status) {
    case CameraStatus::kLearning:
      return {"camera", FindingStatus::kUnknown,
              FormatSentence("only %d fixes at different places: too few to compare the camera with its calibration",
                             camera.estimate.fixes),
              "drive on"};
    case CameraStatus::kAsCalibrated:
      return {"camera", FindingStatus::kOk, "the camera is as it was calibrated", ""};
    case CameraStatus::kCorrected:
      return {"camera", FindingStatus::kNote,
              "the camera differs from its calibration, which is corrected for: " + errors,
              "see whether its mounting was bumped; measure or calibrate it anew"};
    case CameraStatus::kImplausible:
      break;
  }
  return {"camera", FindingStatus::kWrong,
          "the camera differs too much from its calibration to be corrected: " + errors, "calibrate and mount it anew"};
}

}  // namespace floorloc
