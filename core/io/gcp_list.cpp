// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>

#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"

namespace floorloc {
namespace {

constexpr std::size_t kLeastFields = 6;

bool StartsLikeARow(std::string_view text) {
  const std::vector<std::string_view> words = SplitWords(text);
  return words.size() >= kLeastFields && ParseNumber(words[0]) && ParseNumber(words[1]);
}

// Degrees are no map coordinates; whether others are metres, the control points' own check tells.
void RequirePlane(const TextLine& projection, const std::filesystem::path& source) {
  if (StartsLikeARow(projection.text)) {
    throw InputError(source, projection.number,
                     "the first line must name the projection, such as 'WGS84 UTM 32N' or 'EPSG:32632'; add it");
  }
  std::string text(projection.text);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr std::array<std::string_view, 5> kDegrees = {"epsg:4326", "epsg:4258", "epsg:4979", "+proj=longlat",
                                                        "+proj=latlong"};
  if (std::any_of(kDegrees.begin(), kDegrees.end(),
                  [&](std::string_view name) { return text.find(name) != std::string::npos; })) {
    throw InputError(source, projection.number,
                     "longitude and latitude are no map coordinates; convert the points to a plane system in metres, "
                     "such as UTM");
  }
}

}  // namespace

std::vector<ControlPoint> ParseGcpList(const std::string& text, const std::filesystem::path& source) {
  std::vector<TextLine> lines = ContentLines(text);
  if (lines.empty()) {
    return {};
  }
  RequirePlane(lines.front(), source);
  lines.erase(lines.begin());
  std::vector<ControlPoint> points;
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> words = SplitWords(line.text);
    if (words.size() < kLeastFields) {
      throw InputError(source, line.number,
                       "the row has " + std::to_string(words.size()) +
                           " fields; write 'geo_x geo_y geo_z im_x im_y image_name', with blanks between them");
    }
    std::array<double, 5> n{};
    for (std::size_t i = 0; i < n.size(); ++i) {
      const std::optional<double> number = ParseNumber(words[i]);
      // The height may be unknown: it is not used.
      if (!number && i != 2) {
        throw InputError(source, line.number, "'" + std::string(words[i]) + "' is not a number; correct it");
      }
      n[i] = number.value_or(0.0);
    }
    points.push_back({std::string(words[5]), {n[3], n[4]}, {n[0], n[1]}});
  }
  return points;
}

}  // namespace floorloc
