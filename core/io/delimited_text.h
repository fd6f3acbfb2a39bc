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
  std::string_view text;  ///< trimmed; refers to the parsed text
};

/// The lines of a text that are neither blank nor comments (starting with '#'). Accepts Unix and Windows line ends and
/// a UTF-8 byte order mark.
std::vector<TextLine> ContentLines(std::string_view text);

/// "a, b,c" -> {"a", "b", "c"}: trimmed fields, including empty ones.
std::vector<std::string_view> SplitFields(std::string_view line, char separator);
/// Fields separated by commas that may stand in double quotes (RFC 4180): '"a,b", c' -> {"a,b", "c"}. A quote inside of
/// a quoted field stays doubled. Empty when a quote is not closed, or text follows it.
std::optional<std::vector<std::string_view>> SplitCsv(std::string_view line);
/// "a  b\tc" -> {"a", "b", "c"}.
std::vector<std::string_view> SplitWords(std::string_view line);

/// A finite decimal number that is the whole text; independent of the locale. Empty otherwise.
std::optional<double> ParseNumber(std::string_view text);
/// An integer number of nanoseconds within +-kMaxStampNs; empty otherwise.
std::optional<std::int64_t> ParseNanoseconds(std::string_view text);
/// "2.6x1.8" -> {2.6, 1.8}: two decimal numbers without sign and exponent, an 'x' or 'X' between them and nothing else.
std::optional<std::array<double, 2>> ParseSize(std::string_view text);
/// "9x6" -> {9, 6}: two whole numbers of one to three digits, otherwise like ParseSize.
std::optional<std::array<int, 2>> ParseGridSize(std::string_view text);

/// Time stamps lie within +-4e9 s, so that differences of any two fit an int64.
inline constexpr std::int64_t kMaxStampNs = 4'000'000'000'000'000'000;

}  // namespace floorloc
