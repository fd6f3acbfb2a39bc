// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace floorloc {

/// One line of a text file with content.
struct TextLine {
  int number = 0;         ///< counted from 1, as editors do
  std::string_view text;  ///< without blanks at the ends; points into the text it was cut from
};

/// The lines of a text that are neither blank nor comments ('#' comes first). Unix and Windows line ends and a UTF-8
/// byte order mark are fine.
std::vector<TextLine> ContentLines(std::string_view text);

/// "a, b,c" -> {"a", "b", "c"}: fields without blanks at their ends, empty ones included.
std::vector<std::string_view> SplitFields(std::string_view line, char separator);
/// "a  b\tc" -> {"a", "b", "c"}.
std::vector<std::string_view> SplitWords(std::string_view line);

/// A finite decimal number that fills the whole text, whatever the locale.
std::optional<double> ParseNumber(std::string_view text);
/// A whole number of nanoseconds within the range of time stamps (see kMaxStampNs).
std::optional<std::int64_t> ParseNanoseconds(std::string_view text);
/// "2.6x1.8" -> {2.6, 1.8}: two decimal numbers without sign and exponent, an 'x' or 'X' between them and nothing else.
std::optional<std::array<double, 2>> ParseSize(std::string_view text);
/// "9x6" -> {9, 6}: two whole numbers of one to three digits, otherwise like ParseSize.
std::optional<std::array<int, 2>> ParseGridSize(std::string_view text);

/// Time stamps lie within +-4e9 s, so that differences of any two fit an int64.
inline constexpr std::int64_t kMaxStampNs = 4'000'000'000'000'000'000;

}  // namespace floorloc
