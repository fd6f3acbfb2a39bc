// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/drive_check.h"

#include <algorithm>

#include "core/io/jpeg_quality.h"

namespace floorloc {
namespace {

bool AreForeign(const Survey& drive, const StampRange& other) {
  return CompareClocks(StampRange::Of(drive.frames), other, "").has_value();
}

// A reading holds since the one before it.
double GyroBetween(const std::vector<ImuSample>& imu, std::int64_t from_ns, std::int64_t to_ns) {
  auto it = std::upper_bound(imu.begin(), imu.end(), from_ns,
                             [](std::int64_t ns, const ImuSample& sample) { return ns < sample.stamp_ns; });
  double turn_rad = 0.0;
  std::int64_t since_ns = from_ns;
  for (; it != imu.end() && since_ns < to_ns; ++it) {
    const std::int64_t until_ns = std::min(to_ns, it->stamp_ns);
    turn_rad += it->angular_velocity.z() * ToSeconds(until_ns - since_ns);
    since_ns = until_ns;
  }
  return turn_rad;
}

// From one localized frame to the next.
std::vector<GyroTurn> TurnsOf(const std::vector<ImuSample>& imu, const std::vector<FusedFrame>& frames,
                              double max_pair_s) {
  std::vector<GyroTurn> turns;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const LocalizedFrame& before = frames[i - 1].localized;
    const LocalizedFrame& after = frames[i].localized;
    const double seconds = ToSeconds(after.frame.stamp_ns - before.frame.stamp_ns);
    if (before.result.status == LocalizationStatus::kLocalized &&
        after.result.status == LocalizationStatus::kLocalized && seconds <= max_pair_s) {
      turns.push_back({seconds, before.result.map_from_base.Between(after.result.map_from_base).yaw(),
                       GyroBetween(imu, before.frame.stamp_ns, after.frame.stamp_ns)});
    }
  }
  return turns;
}

// Images and odometry in order of time, or one after the other where their times can't be compared.
DriveRecord RecordOf(const Survey& drive, const FusedDrive& fused) {
  DriveRecord record({std::max<std::size_t>(1, fused.frames.size()), std::max<std::size_t>(1, drive.odometry.size())});
  auto next = drive.odometry.begin();
  const bool foreign = !drive.odometry.empty() && AreForeign(drive, StampRange::Of(drive.odometry));
  for (const FusedFrame& frame : fused.frames) {
    const std::int64_t stamp_ns = frame.localized.frame.stamp_ns;
    for (; !foreign && next != drive.odometry.end() && next->stamp_ns <= stamp_ns; ++next) {
      record.AddOdometry(next->stamp_ns);
    }
    record.AddFrame(RecordedFrame::Of(stamp_ns, frame.localized.result, frame.pose));
  }
  for (; next != drive.odometry.end(); ++next) {
    record.AddOdometry(next->stamp_ns);
  }
  return record;
}

// Empty when not even one image in two is compressed too much.
std::vector<Finding> FindingsOfCompression(const FusedDrive& fused, const DiagnosisOptions& options) {
  std::vector<int> qualities;
  std::size_t lost = 0;
  for (const FusedFrame& frame : fused.frames) {
    const LocalizationResult& result = frame.localized.result;
    lost += result.status == LocalizationStatus::kLocalized ? 0 : 1;
    if (result.poor_jpeg_quality) {
      qualities.push_back(*result.poor_jpeg_quality);
    }
  }
  if (2 * qualities.size() < fused.frames.size() || qualities.empty()) {
    return {};
  }
  std::sort(qualities.begin(), qualities.end());
  const double lost_share = static_cast<double>(lost) / static_cast<double>(fused.frames.size());
  const bool works = lost_share <= 1.0 - options.min_localized_share;
  return {{"images", works ? FindingStatus::kNote : FindingStatus::kWrong,
           CompressedTooMuch(qualities[qualities.size() / 2]), ""}};
}

}  // namespace

Survey WithoutForeignClocks(Survey drive) {
  if (!drive.odometry.empty() && AreForeign(drive, StampRange::Of(drive.odometry))) {
    drive.odometry.clear();
  }
  if (!drive.imu.empty() && AreForeign(drive, StampRange::Of(drive.imu))) {
    drive.imu.clear();
  }
  return drive;
}

std::vector<Finding> CheckDrive(const Survey& drive, const FusedDrive& fused, const DiagnosisOptions& options) {
  DiagnosisOptions of_recording = options;
  of_recording.max_stamp_lag_s = 0.0;
  std::optional<ForeignClocks> foreign_imu;
  std::optional<GyroFit> gyro;
  if (!drive.imu.empty()) {
    foreign_imu = CompareClocks(StampRange::Of(drive.frames), StampRange::Of(drive.imu), "the IMU");
    gyro = foreign_imu ? std::nullopt : std::optional(FitGyro(TurnsOf(drive.imu, fused.frames, options.max_pair_s)));
  }
  const ObservedCamera camera = ObservedCamera::Of(fused.camera, fused.camera_off_px, drive.camera);
  std::vector<Finding> findings = Diagnose(RecordOf(drive, fused), camera, gyro, of_recording);
  const std::vector<Finding> compression = FindingsOfCompression(fused, options);
  findings.insert(findings.end(), compression.begin(), compression.end());
  if (foreign_imu) {
    findings.push_back({"gyro", FindingStatus::kWrong, foreign_imu->sentence, foreign_imu->cure});
  }
  return findings;
}

}  // namespace floorloc
