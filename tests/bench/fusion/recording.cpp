// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/recording.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/evaluation/alignment.h"
#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

PoseFix ParseFix(const nlohmann::json& row, std::int64_t stamp_ns) {
  PoseFix fix;
  fix.stamp_ns = stamp_ns;
  fix.map_from_base = Pose2(row.at("x"), row.at("y"), row.at("yaw"));
  const auto covariance = row.at("covariance").get<std::vector<double>>();
  if (covariance.size() != 9) {
    throw std::out_of_range("a covariance needs nine numbers");
  }
  fix.covariance = Eigen::Map<const Eigen::Matrix3d>(covariance.data());
  fix.p_wrong = row.at("p_wrong");
  return fix;
}

// Frames stand in the results in the order of frames.csv: their stamps are exact there.
void ReadFixes(const fs::path& results, const Survey& survey, FusionRecording& recording) {
  std::istringstream lines(ReadTextFile(results));
  std::string line;
  std::size_t count = 0;
  while (std::getline(lines, line)) {
    const int number = static_cast<int>(count) + 1;
    try {
      const nlohmann::json row = nlohmann::json::parse(line);
      const SurveyFrame& frame = survey.frames.at(count++);
      if (row.at("status") == "localized") {
        recording.fixes.push_back(ParseFix(row, frame.stamp_ns));
      } else {
        recording.misses_ns.push_back(frame.stamp_ns);
      }
    } catch (const std::exception& error) {
      throw InputError(results, number, std::string(error.what()) + "; write the file anew with localize --results");
    }
  }
  if (count != survey.frames.size()) {
    throw InputError(results, "does not have one line per frame; write it anew with localize --results");
  }
}

std::vector<std::int64_t> ReadKidnaps(const fs::path& events) {
  std::vector<std::int64_t> kidnaps_ns;
  if (!fs::exists(events)) {
    return kidnaps_ns;
  }
  const std::string text = ReadTextFile(events);
  for (const TextLine& line : ContentLines(text)) {
    const std::vector<std::string_view> fields = SplitFields(line.text, ',');
    if (fields.size() == 3 && fields[2] == "kidnap") {
      const auto stamp_ns = ParseSeconds(std::string(fields[0]));
      if (!stamp_ns) {
        throw InputError(events, line.number, "the time stamp is not a number of seconds; correct the row");
      }
      kidnaps_ns.push_back(*stamp_ns);
    }
  }
  return kidnaps_ns;
}

// Least squares, and again over the better half, so that a wrong fix cannot bend it.
Pose2 MapFromTruth(const std::vector<PoseFix>& fixes, const Trajectory& truth, const fs::path& drive) {
  std::vector<PosePair> pairs;
  for (const PoseFix& fix : fixes) {
    if (const auto pose = InterpolatePose(truth, fix.stamp_ns)) {
      pairs.push_back(
          {StampedPose3::FromPose2(fix.stamp_ns, fix.map_from_base), StampedPose3::FromPose2(fix.stamp_ns, *pose)});
    }
  }
  if (pairs.size() < 10) {
    throw InputError(drive, "has fewer than ten localized frames; give a drive on the map");
  }
  std::vector<PosePair> kept = pairs;
  Similarity3 motion;
  for (int i = 0; i < 3; ++i) {
    motion = ComputeAlignment(kept, AlignmentMode::kSe2);
    const auto error = [&motion](const PosePair& pair) {
      return ((motion * pair.estimate).translation_m - pair.reference.translation_m).norm();
    };
    std::sort(pairs.begin(), pairs.end(),
              [&error](const PosePair& a, const PosePair& b) { return error(a) < error(b); });
    kept.assign(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2));
  }
  return (motion * StampedPose3{}).ToPose2();
}

}  // namespace

FusionRecording ReadFusionRecording(const fs::path& drive, const fs::path& results) {
  const Survey survey = ReadSurvey(drive);
  FusionRecording recording;
  recording.name = drive.filename().string();
  recording.odometry = survey.odometry;
  for (const ImuSample& sample : survey.imu) {
    recording.imu.push_back({sample.stamp_ns, sample.angular_velocity.z(), sample.acceleration.head<2>()});
  }
  ReadFixes(results, survey, recording);
  recording.kidnaps_ns = ReadKidnaps(drive / "events.csv");
  const Trajectory truth = ReadTum(drive / "groundtruth_dense.tum");
  const Pose2 map_from_truth = MapFromTruth(recording.fixes, survey.ground_truth, drive);
  for (const StampedPose3& pose : truth) {
    recording.truth.push_back(StampedPose3::FromPose2(pose.stamp_ns, map_from_truth * pose.ToPose2()));
  }
  if (recording.truth.size() != recording.odometry.size()) {
    throw InputError(drive, "must have one row of groundtruth_dense.tum per row of odometry.tum; simulate it anew");
  }
  return recording;
}

}  // namespace floorloc
