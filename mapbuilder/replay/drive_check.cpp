// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/drive_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "core/geometry/option_check.h"
#include "mapbuilder/replay/gyro_fit.h"

namespace floorloc {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

bool IsLocalized(const FusedFrame& frame) { return frame.localized.result.status == LocalizationStatus::kLocalized; }

// Why images are not localized, by the reason that is the most frequent.
const char* CureOf(NotLocalizedReason reason) {
  switch (reason) {
    case NotLocalizedReason::kTooFewKeypoints:
      return "they show too little structure: dark, overexposed, blurred or dirty";
    case NotLocalizedReason::kViewDisagrees:
      return "they agree with the map in a part of the view only: something in view is not floor, or the floor changed";
    default:
      return "they do not match the map: another floor, worn or changed floor, or a camera.yaml and floor.yaml of "
             "another camera";
  }
}

CheckFinding CheckFloor(const FusedDrive& fused, const DriveCheckOptions& options) {
  int localized = 0;
  std::map<NotLocalizedReason, int> reasons;
  for (const FusedFrame& frame : fused.frames) {
    localized += IsLocalized(frame) ? 1 : 0;
    ++reasons[frame.localized.result.reason];
  }
  reasons.erase(NotLocalizedReason::kNone);
  const double share = localized / std::max(1.0, static_cast<double>(fused.frames.size()));
  std::string sentence = Format("%d of %zu images were found in the map", localized, fused.frames.size());
  if (share >= options.min_localized_share) {
    return {"floor", CheckStatus::kOk, sentence};
  }
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  sentence += std::string("; ") + CureOf(most == reasons.end() ? NotLocalizedReason::kNone : most->first);
  return {"floor", share < options.lost_localized_share ? CheckStatus::kWrong : CheckStatus::kNote, sentence};
}

// How far apart images are, against the length of a view.
CheckFinding CheckImages(const Survey& drive, const FusedDrive& fused, const DriveCheckOptions& options) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < fused.frames.size(); ++i) {
    if (IsLocalized(fused.frames[i - 1]) && IsLocalized(fused.frames[i])) {
      steps_m.push_back(fused.frames[i - 1]
                            .localized.result.map_from_base.Between(fused.frames[i].localized.result.map_from_base)
                            .translation()
                            .norm());
    }
  }
  if (steps_m.empty()) {
    return {"images", CheckStatus::kNote, "no two images in a row were found: their distance is unknown"};
  }
  std::sort(steps_m.begin(), steps_m.end());
  const double step_m = steps_m[steps_m.size() * 9 / 10];
  const RectM& roi = drive.camera.floor.roi;
  const double view_m = std::min(roi.width_m(), roi.height_m());
  const std::string sentence = Format("images are up to %.2f m apart (90 %%), a view is %.2f m wide", step_m, view_m);
  if (step_m <= options.max_step_share * view_m) {
    return {"images", CheckStatus::kOk, sentence};
  }
  return {"images", CheckStatus::kNote,
          sentence +
              ": the motion between images can't be seen; take them more often, or drive more slowly, where "
              "wheels may slip"};
}

CheckFinding CheckCamera(const FusedDrive& fused) {
  const CameraErrors& e = fused.camera.errors.mean;
  const std::string errors =
      Format("roll %+.2f, pitch %+.2f degrees, height %+.1f %%, floor points off by up to %.1f px", kDegrees * e(0),
             kDegrees * e(1), 100.0 * e(2), fused.camera_off_px);
  switch (fused.camera.status) {
    case CameraStatus::kLearning:
      return {"camera", CheckStatus::kNote,
              Format("only %d fixes at different places: too few to compare the camera with its calibration",
                     fused.camera.fixes)};
    case CameraStatus::kAsCalibrated:
      return {"camera", CheckStatus::kOk, "the camera is as it was calibrated"};
    case CameraStatus::kCorrected:
      return {"camera", CheckStatus::kNote,
              "the camera differs from its calibration, which is corrected for: " + errors + "; was it bumped?"};
    case CameraStatus::kImplausible:
      break;
  }
  return {"camera", CheckStatus::kWrong,
          "the camera differs too much from its calibration to be corrected: " + errors + "; calibrate it anew"};
}

// Empty when the stamps overlap.
std::vector<CheckFinding> CheckStamps(const Survey& drive) {
  const Trajectory& odometry = drive.odometry;
  if (odometry.front().stamp_ns <= drive.frames.back().stamp_ns &&
      odometry.back().stamp_ns >= drive.frames.front().stamp_ns) {
    return {};
  }
  return {{"odometry", CheckStatus::kWrong,
           Format("images are stamped from %.1f to %.1f s, odometry from %.1f to %.1f s: give both the same clock",
                  ToSeconds(drive.frames.front().stamp_ns), ToSeconds(drive.frames.back().stamp_ns),
                  ToSeconds(odometry.front().stamp_ns), ToSeconds(odometry.back().stamp_ns))}};
}

// What the images said of the odometry over the drive.
struct TrustOverDrive {
  OdometryTrust last;
  OdometryFault most_frequent = OdometryFault::kNone;  // but for other clocks
  int faulty_images = 0;                               // with that fault
};

TrustOverDrive FollowTrust(const FusedDrive& fused) {
  TrustOverDrive trust;
  std::map<OdometryFault, int> faults;
  for (const FusedFrame& frame : fused.frames) {
    if (frame.pose && frame.pose->odometry) {
      trust.last = *frame.pose->odometry;
      ++faults[trust.last.fault];
    }
  }
  for (const auto& [fault, count] : faults) {
    const bool counts = fault != OdometryFault::kNone && fault != OdometryFault::kTimeOffset;
    if (counts && count > trust.faulty_images) {
      trust.most_frequent = fault;
      trust.faulty_images = count;
    }
  }
  return trust;
}

CheckFinding CheckDirection(const TrustOverDrive& trust, std::size_t images, const DriveCheckOptions& options) {
  const std::string scales =
      Format("distances to be multiplied by %.3f, turns by %.3f", trust.last.scale, trust.last.yaw_scale);
  const double share = trust.faulty_images / std::max(1.0, static_cast<double>(images));
  if (share > options.max_faulty_share) {
    return {"odometry", CheckStatus::kWrong, std::string(CureOf(trust.most_frequent)) + " (" + scales + ")"};
  }
  if (trust.last.health == OdometryHealth::kLearning) {
    return {"odometry", CheckStatus::kNote, "too few fixes to compare odometry with: drive a loop of some metres"};
  }
  if (trust.faulty_images > 0) {
    return {
        "odometry", CheckStatus::kNote,
        Format("odometry contradicted %d of %zu images (%s) and was not used there: did the wheels slip, or was the "
               "vehicle carried?",
               trust.faulty_images, images, ToString(trust.most_frequent))};
  }
  const double error = std::max(std::abs(trust.last.scale - 1.0), std::abs(trust.last.yaw_scale - 1.0));
  return error <= options.max_scale_error
             ? CheckFinding{"odometry", CheckStatus::kOk, "odometry agrees with the images: " + scales}
             : CheckFinding{"odometry", CheckStatus::kNote,
                            "odometry is a little off, which is corrected for: " + scales};
}

CheckFinding CheckClock(const OdometryTrust& trust, const DriveCheckOptions& options) {
  const double offset_s = trust.time_offset_s;
  if (std::abs(offset_s) <= options.max_offset_s) {
    return {"clock", CheckStatus::kOk, "no difference between the clocks of images and odometry was seen"};
  }
  return {"clock", CheckStatus::kNote,
          Format("odometry is stamped %.0f ms %s than the images, which is compensated: synchronize the clocks, or "
                 "stamp images when they are exposed",
                 1e3 * std::abs(offset_s), offset_s > 0.0 ? "later" : "earlier")};
}

std::vector<CheckFinding> CheckGaps(const Survey& drive, const DriveCheckOptions& options) {
  double longest_s = 0.0;
  for (std::size_t i = 1; i < drive.odometry.size(); ++i) {
    longest_s = std::max(longest_s, ToSeconds(drive.odometry[i].stamp_ns - drive.odometry[i - 1].stamp_ns));
  }
  if (longest_s <= options.max_gap_s) {
    return {};
  }
  return {{"odometry", CheckStatus::kNote,
           Format("odometry has a gap of %.1f s: the pose is not propagated for so long", longest_s)}};
}

CheckFinding CheckGyro(const Survey& drive, const FusedDrive& fused, const DriveCheckOptions& options) {
  const GyroFit fit = FitGyro(drive.imu, fused.frames, options.max_pair_s);
  if (fit.turned_rad < options.min_turn_rad) {
    return {"gyro", CheckStatus::kNote, "the drive has too few turns to judge the gyro: drive a circle"};
  }
  constexpr double kDegreeScale = 1.0 / kDegrees;
  if (fit.scale > 0.5 * kDegreeScale && fit.scale < 2.0 * kDegreeScale) {
    return {"gyro", CheckStatus::kWrong, "the gyro is in degrees per second: imu.csv wants radians"};
  }
  if (fit.scale < 0.0) {
    return {"gyro", CheckStatus::kWrong,
            "the gyro turns right while the images turn left: its z axis points down, or its sign is wrong"};
  }
  const std::string numbers = Format("scale %.3f, bias %+.4f rad/s", fit.scale, fit.bias_rad_s);
  if (std::abs(fit.scale - 1.0) > options.max_gyro_scale_error) {
    return {"gyro", CheckStatus::kWrong, "the gyro's turns are not those of the images: " + numbers};
  }
  return std::abs(fit.bias_rad_s) <= options.max_gyro_bias_rad_s
             ? CheckFinding{"gyro", CheckStatus::kOk, "the gyro agrees with the images: " + numbers}
             : CheckFinding{"gyro", CheckStatus::kNote,
                            "the gyro has a large bias, which is estimated along the way: " + numbers};
}

}  // namespace

const char* ToString(CheckStatus status) {
  switch (status) {
    case CheckStatus::kOk:
      return "ok";
    case CheckStatus::kNote:
      return "note";
    case CheckStatus::kWrong:
      return "wrong";
  }
  return "";
}

void DriveCheckOptions::Check() const {
  RequireOption(min_localized_share > 0.0 && min_localized_share <= 1.0, "min_localized_share must be 0 to 1");
  RequireOption(lost_localized_share >= 0.0 && lost_localized_share <= min_localized_share,
                "lost_localized_share must be at most min_localized_share");
  RequireOption(max_step_share > 0.0, "max_step_share must be positive");
  RequireOption(max_gap_s > 0.0, "max_gap_s must be positive");
  RequireOption(max_offset_s >= 0.0, "max_offset_s must not be negative");
  RequireOption(max_faulty_share >= 0.0, "max_faulty_share must not be negative");
  RequireOption(max_scale_error >= 0.0, "max_scale_error must not be negative");
  RequireOption(max_gyro_scale_error >= 0.0, "max_gyro_scale_error must not be negative");
  RequireOption(max_gyro_bias_rad_s >= 0.0, "max_gyro_bias_rad_s must not be negative");
  RequireOption(min_turn_rad > 0.0, "min_turn_rad must be positive");
  RequireOption(max_pair_s > 0.0, "max_pair_s must be positive");
}

std::vector<CheckFinding> CheckDrive(const Survey& drive, const FusedDrive& fused, const DriveCheckOptions& options) {
  options.Check();
  std::vector<CheckFinding> findings{CheckFloor(fused, options), CheckImages(drive, fused, options),
                                     CheckCamera(fused)};
  if (drive.odometry.empty()) {
    findings.push_back({"odometry", CheckStatus::kNote,
                        "there is no odometry.tum: between images, and where they fail, the pose is unknown"});
  } else if (const std::vector<CheckFinding> apart = CheckStamps(drive); !apart.empty()) {
    findings.insert(findings.end(), apart.begin(), apart.end());
  } else {
    const TrustOverDrive trust = FollowTrust(fused);
    findings.push_back(CheckDirection(trust, fused.frames.size(), options));
    const std::vector<CheckFinding> gaps = CheckGaps(drive, options);
    findings.insert(findings.end(), gaps.begin(), gaps.end());
    findings.push_back(CheckClock(trust.last, options));
  }
  if (!drive.imu.empty()) {
    findings.push_back(CheckGyro(drive, fused, options));
  }
  return findings;
}

CheckStatus WorstOf(const std::vector<CheckFinding>& findings) {
  CheckStatus worst = CheckStatus::kOk;
  for (const CheckFinding& finding : findings) {
    worst = std::max(worst, finding.status);
  }
  return worst;
}

}  // namespace floorloc
