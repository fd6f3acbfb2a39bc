// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <unordered_set>

#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/stamp_range.h"
#include "core/io/survey.h"

namespace floorloc {
namespace {

std::vector<std::string_view> SplitRow(const TextLine& line, const std::filesystem::path& source) {
  std::optional<std::vector<std::string_view>> fields = SplitCsv(line.text);
  if (!fields) {
    throw InputError(source, line.number,
                     "a quoted field must end with a quote before the next comma or the end of the line; correct it");
  }
  return std::move(*fields);
}

// Checks the header line and returns the rows after it.
std::vector<TextLine> RowsBelowHeader(std::string_view text, const std::string& header,
                                      const std::filesystem::path& source) {
  std::vector<TextLine> lines = ContentLines(text);
  if (lines.empty()) {
    return lines;
  }
  const std::vector<std::string_view> expected = SplitFields(header, ',');
  for (const char other : {';', '\t'}) {
    if (SplitFields(lines.front().text, other) == expected) {
      throw InputError(source, lines.front().number,
                       std::string("the columns are separated by ") + (other == ';' ? "semicolons" : "tabs") +
                           "; save the file with commas between them, and points in the numbers");
    }
  }
  if (SplitRow(lines.front(), source) != expected) {
    throw InputError(source, lines.front().number, "the first line must be '" + header + "'; add it");
  }
  lines.erase(lines.begin());
  return lines;
}

std::vector<std::string_view> FieldsOf(const TextLine& line, const std::string& columns,
                                       const std::filesystem::path& source) {
  std::vector<std::string_view> fields = SplitRow(line, source);
  const std::size_t count = SplitFields(columns, ',').size();
  if (fields.size() != count) {
    throw InputError(source, line.number,
                     "the row has " + std::to_string(fields.size()) + " fields instead of " + std::to_string(count) +
                         "; write '" + columns + "'");
  }
  return fields;
}

template <std::size_t kCount>
std::array<double, kCount> Numbers(std::span<const std::string_view> fields, int line,
                                   const std::filesystem::path& source) {
  std::array<double, kCount> numbers{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::optional<double> number = ParseNumber(fields[i]);
    if (!number) {
      throw InputError(source, line,
                       "'" + std::string(fields[i]) +
                           "' is not a finite number; correct or delete the "
                           "row");
    }
    numbers[i] = *number;
  }
  return numbers;
}

void CheckIncreasing(std::int64_t stamp_ns, std::int64_t previous_ns, int line, const std::filesystem::path& source) {
  if (stamp_ns <= previous_ns) {
    throw InputError(source, line,
                     "the time stamp " + FormatSeconds(stamp_ns) + " s is not later than the one before, " +
                         FormatSeconds(previous_ns) +
                         " s; sort the rows by time and delete duplicates, or where the clock was set, cut the "
                         "recording there");
  }
}

// A file name as it is on this system: with slashes, as Windows accepts them too, without quotes for quotes and "./".
std::string ToFilename(std::string_view field) {
  std::string name;
  for (std::size_t i = 0; i < field.size(); ++i) {
    i += field.substr(i).starts_with("\"\"") ? 1 : 0;
    name += field[i] == '\\' ? '/' : field[i];
  }
  while (name.starts_with("./")) {
    name.erase(0, 2);
  }
  return name;
}

bool HasDriveLetter(const std::string& name) {
  return name.size() > 1 && name[1] == ':' && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
}

// Images must be inside the survey folder: a path out of it is a mistake or an attack.
std::string FilenameOf(std::string_view field, int line, const std::filesystem::path& source) {
  std::string filename = ToFilename(field);
  const std::filesystem::path path(filename);
  bool inside =
      !filename.empty() && path.is_relative() && !HasDriveLetter(filename) && filename.find('\0') == std::string::npos;
  for (const std::filesystem::path& part : path) {
    inside = inside && part != "..";
  }
  if (!inside) {
    throw InputError(source, line,
                     "the file name '" + filename +
                         "' is not inside the folder; write it relative "
                         "to the folder, as images/000000.jpg");
  }
  return filename;
}

}  // namespace

std::vector<SurveyFrame> ParseFramesCsv(const std::string& text, const std::filesystem::path& source,
                                        BadFramePolicy bad_frames) {
  const std::string columns = "timestamp,filename";
  std::vector<SurveyFrame> frames;
  std::unordered_set<std::string> seen;
  for (const TextLine& line : RowsBelowHeader(text, columns, source)) {
    const std::vector<std::string_view> fields = FieldsOf(line, columns, source);
    const std::optional<std::int64_t> stamp_ns = ParseSeconds(std::string(fields[0]));
    if (!stamp_ns) {
      throw InputError(source, line.number,
                       "the time stamp '" + std::string(fields[0]) + "' is not a number of seconds; " +
                           HintAboutUnit(fields[0]).value_or("correct or delete the row"));
    }
    SurveyFrame frame{*stamp_ns, FilenameOf(fields[1], line.number, source)};
    if (!frames.empty() && bad_frames == BadFramePolicy::kThrow) {
      CheckIncreasing(frame.stamp_ns, frames.back().stamp_ns, line.number, source);
    }
    if (!seen.insert(frame.filename).second) {
      throw InputError(source, line.number,
                       "the image " + frame.filename +
                           " is listed twice; delete one of the "
                           "rows");
    }
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) {
    throw InputError(source, "has no frames; list them below the line 'timestamp,filename'");
  }
  return frames;
}

std::vector<ImuSample> ParseImuCsv(const std::string& text, const std::filesystem::path& source) {
  std::vector<ImuSample> samples;
  for (const TextLine& line : ContentLines(text)) {
    const std::vector<std::string_view> fields = FieldsOf(line, "timestamp [ns],wx,wy,wz,ax,ay,az", source);
    const std::optional<std::int64_t> stamp_ns = ParseNanoseconds(fields[0]);
    if (!stamp_ns) {
      throw InputError(source, line.number,
                       "the time stamp is not a whole number of nanoseconds; correct or delete "
                       "the row");
    }
    const auto n = Numbers<6>(std::span(fields).subspan(1), line.number, source);
    if (!samples.empty()) {
      CheckIncreasing(*stamp_ns, samples.back().stamp_ns, line.number, source);
    }
    samples.push_back({*stamp_ns, {n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
  }
  return samples;
}

std::string FormatImuCsv(const std::vector<ImuSample>& samples) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  std::array<char, 160> row{};
  for (const ImuSample& sample : samples) {
    const Eigen::Vector3d& w = sample.angular_velocity;
    const Eigen::Vector3d& a = sample.acceleration;
    std::snprintf(row.data(), row.size(), "%lld,%.7f,%.7f,%.7f,%.7f,%.7f,%.7f\n",
                  static_cast<long long>(sample.stamp_ns), w.x(), w.y(), w.z(), a.x(), a.y(), a.z());
    text += row.data();
  }
  return text;
}

std::vector<ControlPoint> ParseControlPointsCsv(const std::string& text, const std::filesystem::path& source) {
  const std::vector<TextLine> lines = ContentLines(text);
  const bool with_sigma = !lines.empty() && SplitFields(lines.front().text, ',').size() == 6;
  const std::string columns = with_sigma ? "filename,u,v,x,y,sigma" : "filename,u,v,x,y";
  std::vector<ControlPoint> points;
  for (const TextLine& line : RowsBelowHeader(text, columns, source)) {
    const std::vector<std::string_view> fields = FieldsOf(line, columns, source);
    const std::string filename = FilenameOf(fields[0], line.number, source);
    const auto n = Numbers<4>(std::span(fields).subspan(1, 4), line.number, source);
    ControlPoint point{filename, {n[0], n[1]}, {n[2], n[3]}};
    if (with_sigma && !fields[5].empty()) {
      point.sigma_m = Numbers<1>(std::span(fields).subspan(5), line.number, source)[0];
      if (!(*point.sigma_m > 0.0)) {
        throw InputError(source, line.number, "the sigma is not positive; write metres, or leave it empty");
      }
    }
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<KnownDistance> ParseKnownDistancesCsv(const std::string& text, const std::filesystem::path& source) {
  const std::string columns = "filename1,u1,v1,filename2,u2,v2,distance";
  std::vector<KnownDistance> distances;
  for (const TextLine& line : RowsBelowHeader(text, columns, source)) {
    const std::vector<std::string_view> fields = FieldsOf(line, columns, source);
    const auto first = Numbers<2>(std::span(fields).subspan(1, 2), line.number, source);
    const auto rest = Numbers<2>(std::span(fields).subspan(4, 2), line.number, source);
    const auto distance = Numbers<1>(std::span(fields).subspan(6), line.number, source);
    KnownDistance row{FilenameOf(fields[0], line.number, source),
                      {first[0], first[1]},
                      FilenameOf(fields[3], line.number, source),
                      {rest[0], rest[1]},
                      distance[0]};
    if (!(row.distance_m > 0.0)) {
      throw InputError(source, line.number, "the distance is not positive; write it in metres");
    }
    distances.push_back(std::move(row));
  }
  return distances;
}

std::vector<KnownMarker> ParseMarkersCsv(const std::string& text, const std::filesystem::path& source) {
  constexpr double kMaxId = 100000;
  const std::string columns = "id,x,y,yaw";
  std::vector<KnownMarker> markers;
  std::unordered_set<int> seen;
  for (const TextLine& line : RowsBelowHeader(text, columns, source)) {
    const std::vector<std::string_view> fields = FieldsOf(line, columns, source);
    const auto n = Numbers<3>(fields, line.number, source);
    if (n[0] < 0 || n[0] > kMaxId || n[0] != std::floor(n[0])) {
      throw InputError(source, line.number, "the marker's id must be a whole number from 0; correct it");
    }
    KnownMarker marker{static_cast<int>(n[0]), {n[1], n[2]}, std::nullopt, line.number};
    if (!fields[3].empty()) {
      marker.yaw_rad = Numbers<1>(std::span(fields).subspan(3), line.number, source)[0];
      if (std::abs(*marker.yaw_rad) > 2.0 * std::numbers::pi) {
        throw InputError(source, line.number,
                         "the yaw '" + std::string(fields[3]) + "' is more than a full turn; write it in radians");
      }
    }
    if (!seen.insert(marker.id).second) {
      throw InputError(source, line.number,
                       "the marker " + std::to_string(marker.id) + " is listed twice; delete one of the rows");
    }
    markers.push_back(marker);
  }
  if (markers.empty()) {
    throw InputError(source, "has no markers; list them below the line 'id,x,y,yaw'");
  }
  return markers;
}

}  // namespace floorloc
