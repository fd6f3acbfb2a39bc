// SPDX-License-Identifier: Apache-2.0
#include "core/io/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/stamp_range.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr std::size_t kPoseFields = 8;
constexpr double kMaxPositionM = 1e9;

// Source of a row, for error messages.
struct Row {
  const std::filesystem::path& source;
  const TextLine& line;

  [[noreturn]] void Fail(const std::string& reason) const { throw InputError(source, line.number, reason); }
};

// Numbers 2 to 8 of a row: the position, then the quaternion. Stamps are parsed separately because they need more
// digits than a double has.
std::array<double, kPoseFields - 1> ParsePoseNumbers(std::span<const std::string_view> fields, const Row& row) {
  std::array<double, kPoseFields - 1> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = ParseNumber(fields[i + 1]);
    if (!number) {
      row.Fail("number " + std::to_string(i + 2) + " of the row is not a finite number; correct or delete the row");
    }
    numbers[i] = *number;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(numbers[i]) > kMaxPositionM) {
      row.Fail("the position is farther than 1e9 m from the origin; check the order of the columns and the units");
    }
  }
  return numbers;
}

Eigen::Quaterniond CheckedRotation(const Eigen::Quaterniond& q, const Row& row) {
  constexpr double kTolerance = 1e-2;
  if (!(std::abs(q.norm() - 1.0) <= kTolerance)) {
    row.Fail("the quaternion has the norm " + std::to_string(q.norm()) +
             " instead of 1; check the order of the columns");
  }
  return q.normalized();
}

void AppendInOrder(Trajectory& trajectory, const StampedPose3& pose, const Row& row) {
  if (!trajectory.empty() && pose.stamp_ns <= trajectory.back().stamp_ns) {
    row.Fail("the time stamp " + FormatSeconds(pose.stamp_ns) + " s is not later than the one before, " +
             FormatSeconds(trajectory.back().stamp_ns) +
             " s; sort the rows by time and delete duplicates, or where the clock was set, cut the recording there");
  }
  trajectory.push_back(pose);
}

StampedPose3 ParseTumRow(const Row& row) {
  const std::vector<std::string_view> fields = SplitWords(row.line.text);
  if (fields.size() != kPoseFields) {
    row.Fail("the row has " + std::to_string(fields.size()) +
             " numbers instead of 8; write 'timestamp tx ty tz qx qy qz qw'");
  }
  const std::optional<std::int64_t> stamp_ns = ParseSeconds(std::string(fields[0]));
  if (!stamp_ns) {
    row.Fail("the time stamp is not a number of seconds; " +
             HintAboutUnit(fields[0]).value_or("correct or delete the row"));
  }
  const auto n = ParsePoseNumbers(fields, row);
  return {*stamp_ns, {n[0], n[1], n[2]}, CheckedRotation({n[6], n[3], n[4], n[5]}, row)};
}

StampedPose3 ParseEurocRow(const Row& row) {
  const std::vector<std::string_view> fields = SplitFields(row.line.text, ',');
  if (fields.size() < kPoseFields) {
    row.Fail("the row has " + std::to_string(fields.size()) +
             " numbers instead of at least 8; write 'timestamp [ns],px,py,pz,qw,qx,qy,qz'");
  }
  const std::optional<std::int64_t> stamp_ns = ParseNanoseconds(fields[0]);
  if (!stamp_ns) {
    row.Fail("the time stamp is not a whole number of nanoseconds; correct or delete the row");
  }
  const auto n = ParsePoseNumbers(fields, row);
  return {*stamp_ns, {n[0], n[1], n[2]}, CheckedRotation({n[3], n[4], n[5], n[6]}, row)};
}

template <typename ParseRow>
Trajectory ParseRows(const std::string& text, const std::filesystem::path& source, ParseRow parse_row) {
  Trajectory trajectory;
  for (const TextLine& line : ContentLines(text)) {
    const Row row{source, line};
    AppendInOrder(trajectory, parse_row(row), row);
  }
  if (trajectory.empty()) {
    throw InputError(source, "has no poses; delete it or fill it");
  }
  return trajectory;
}

}  // namespace

Pose2 StampedPose3::ToPose2() const {
  const Eigen::Quaterniond& q = rotation;
  const double yaw = std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()), 1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
  return {translation_m.x(), translation_m.y(), yaw};
}

StampedPose3 StampedPose3::FromPose2(std::int64_t stamp_ns, const Pose2& pose) {
  const double half_yaw = 0.5 * pose.yaw();
  return {stamp_ns, {pose.x(), pose.y(), 0.0}, {std::cos(half_yaw), 0.0, 0.0, std::sin(half_yaw)}};
}

Trajectory ParseTum(const std::string& text, const std::filesystem::path& source) {
  return ParseRows(text, source, ParseTumRow);
}

Trajectory ReadTum(const std::filesystem::path& file) { return ParseTum(ReadTextFile(file), file); }

std::string FormatTum(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose3& pose : trajectory) {
    const Eigen::Vector3d& t = pose.translation_m;
    const Eigen::Quaterniond& q = pose.rotation;
    std::array<char, 512> numbers{};
    std::snprintf(numbers.data(), numbers.size(), " %.9f %.9f %.9f %.12f %.12f %.12f %.12f\n", t.x(), t.y(), t.z(),
                  q.x(), q.y(), q.z(), q.w());
    text += FormatSeconds(pose.stamp_ns);
    text += numbers.data();
  }
  return text;
}

Trajectory ParseEurocCsv(const std::string& text, const std::filesystem::path& source) {
  return ParseRows(text, source, ParseEurocRow);
}

Trajectory ReadTrajectory(const std::filesystem::path& file) {
  return file.extension() == ".csv" ? ParseEurocCsv(ReadTextFile(file), file) : ReadTum(file);
}

std::optional<Pose2> InterpolatePose(const Trajectory& trajectory, std::int64_t stamp_ns, double max_gap_s) {
  const auto next = std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                                     [](const StampedPose3& pose, std::int64_t ns) { return pose.stamp_ns < ns; });
  if (next == trajectory.end()) {
    return std::nullopt;
  }
  if (next->stamp_ns == stamp_ns) {
    return next->ToPose2();
  }
  if (next == trajectory.begin()) {
    return std::nullopt;
  }
  const StampedPose3& previous = *std::prev(next);
  const double gap_s = ToSeconds(next->stamp_ns - previous.stamp_ns);
  if (gap_s > max_gap_s) {
    return std::nullopt;
  }
  const double fraction = ToSeconds(stamp_ns - previous.stamp_ns) / gap_s;
  const Pose2 start = previous.ToPose2();
  return start * Pose2::Exp(fraction * start.Between(next->ToPose2()).Log());
}

}  // namespace floorloc
