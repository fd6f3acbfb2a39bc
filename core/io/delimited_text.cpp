// SPDX-License-Identifier: Apache-2.0
#include "core/io/delimited_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace floorloc {
namespace {

constexpr std::string_view kBlanks = " \t\r\f\v";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view Trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// from_chars does not accept a leading plus sign.
std::string_view StripPlus(std::string_view text) {
  const bool has_plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return has_plus ? text.substr(1) : text;
}

template <typename Number>
std::optional<Number> ParseWhole(std::string_view text) {
  const std::string_view digits = StripPlus(text);
  Number value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    return std::nullopt;
  }
  return value;
}

constexpr std::string_view kDigits = "0123456789";

// The texts on both sides of the only 'x'; each begins with a digit and holds nothing but `allowed` characters.
std::optional<std::array<std::string_view, 2>> SplitSize(std::string_view text, std::string_view allowed) {
  const std::size_t x = text.find_first_of("xX");
  if (x == std::string_view::npos) {
    return std::nullopt;
  }
  const std::array<std::string_view, 2> sides{text.substr(0, x), text.substr(x + 1)};
  for (const std::string_view side : sides) {
    if (side.find_first_of(kDigits) != 0 || side.find_first_not_of(allowed) != std::string_view::npos) {
      return std::nullopt;
    }
  }
  return sides;
}

}  // namespace

std::vector<TextLine> ContentLines(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = Trim(text.substr(0, end));
    if (!line.empty() && line.front() != '#') {
      lines.push_back({number, line});
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> SplitFields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = line.find(separator, begin);
    fields.push_back(Trim(line.substr(begin, end - begin)));
    if (end == std::string_view::npos) {
      return fields;
    }
    begin = end + 1;
  }
}

std::optional<std::vector<std::string_view>> SplitCsv(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    line = Trim(line);
    std::size_t end = std::min(line.find(','), line.size());
    if (line.starts_with('"')) {
      std::size_t close = line.find('"', 1);
      while (close != std::string_view::npos && line.substr(close).starts_with("\"\"")) {
        close = line.find('"', close + 2);
      }
      if (close == std::string_view::npos) {
        return std::nullopt;
      }
      end = std::min(line.find(',', close), line.size());
      if (!Trim(line.substr(close + 1, end - close - 1)).empty()) {
        return std::nullopt;
      }
      fields.push_back(line.substr(1, close - 1));
    } else {
      fields.push_back(Trim(line.substr(0, end)));
    }
    if (end == line.size()) {
      return fields;
    }
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> SplitWords(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::optional<double> ParseNumber(std::string_view text) {
  const std::optional<double> value = ParseWhole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> ParseNanoseconds(std::string_view text) {
  const std::optional<std::int64_t> value = ParseWhole<std::int64_t>(text);
  return value && *value >= -kMaxStampNs && *value <= kMaxStampNs ? value : std::nullopt;
}

std::optional<std::array<double, 2>> ParseSize(std::string_view text) {
  const auto sides = SplitSize(text, "0123456789.");
  const std::optional<double> width = sides ? ParseNumber((*sides)[0]) : std::nullopt;
  const std::optional<double> height = sides ? ParseNumber((*sides)[1]) : std::nullopt;
  return width && height ? std::optional(std::array{*width, *height}) : std::nullopt;
}

std::optional<std::array<int, 2>> ParseGridSize(std::string_view text) {
  constexpr std::size_t kMaxDigits = 3;
  const auto sides = SplitSize(text, kDigits);
  if (!sides || std::max((*sides)[0].size(), (*sides)[1].size()) > kMaxDigits) {
    return std::nullopt;
  }
  return std::array{*ParseWhole<int>((*sides)[0]), *ParseWhole<int>((*sides)[1])};
}

}  // namespace floorloc
