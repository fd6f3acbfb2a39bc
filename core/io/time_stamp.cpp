// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <charconv>
#include <cstdio>
#include <string_view>

#include "core/io/delimited_text.h"
#include "core/io/trajectory.h"

namespace floorloc {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

// A decimal number: 0.d1d2d3... * 10^point.
struct Decimal {
  bool negative = false;
  std::string digits;
  int point = 0;
};

std::string_view TakeDigits(std::string_view& text) {
  std::size_t count = 0;
  while (count < text.size() && std::isdigit(static_cast<unsigned char>(text[count])) != 0) {
    ++count;
  }
  const std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  return digits;
}

// The exponent after a number ("e+09"); zero when there is none. Exponents too large for any time stamp are rejected.
std::optional<int> ParseExponent(std::string_view text) {
  if (text.empty()) {
    return 0;
  }
  const std::optional<double> exponent = ParseNumber(text.substr(1));
  const bool is_whole = exponent && text.substr(1).find_first_of(".eE") == std::string_view::npos;
  if (std::tolower(static_cast<unsigned char>(text[0])) != 'e' || !is_whole || *exponent < -99 || *exponent > 99) {
    return std::nullopt;
  }
  return static_cast<int>(*exponent);
}

std::optional<Decimal> ParseDecimal(std::string_view text) {
  Decimal decimal;
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) {
    decimal.negative = text[0] == '-';
    text.remove_prefix(1);
  }
  decimal.digits = TakeDigits(text);
  decimal.point = static_cast<int>(decimal.digits.size());
  if (!text.empty() && text[0] == '.') {
    text.remove_prefix(1);
    decimal.digits += TakeDigits(text);
  }
  const std::optional<int> exponent = ParseExponent(text);
  if (decimal.digits.empty() || !exponent) {
    return std::nullopt;
  }
  decimal.point += *exponent;
  return decimal;
}

}  // namespace

std::optional<std::int64_t> ParseSeconds(const std::string& text) {
  constexpr std::size_t kMaxText = 100;
  const std::optional<Decimal> decimal = text.size() <= kMaxText ? ParseDecimal(text) : std::nullopt;
  if (!decimal) {
    return std::nullopt;
  }
  // The first `whole` digits are nanoseconds; the next one is for rounding.
  const int whole = decimal->point + 9;
  if (whole < 0) {
    return 0;
  }
  std::string digits = decimal->digits;
  const auto length = static_cast<std::size_t>(whole);
  const bool round_up = digits.size() > length && digits[length] >= '5';
  digits.resize(length, '0');
  const std::optional<std::int64_t> magnitude = ParseNanoseconds("0" + digits);
  if (!magnitude) {
    return std::nullopt;
  }
  const std::int64_t stamp_ns = *magnitude + (round_up ? 1 : 0);
  return decimal->negative ? -stamp_ns : stamp_ns;
}

std::string FormatSeconds(std::int64_t stamp_ns) {
  const std::int64_t seconds = stamp_ns / kNsPerSecond;
  const std::int64_t rest = stamp_ns % kNsPerSecond;
  char text[40];
  std::snprintf(text, sizeof(text), "%s%lld.%09lld", stamp_ns < 0 ? "-" : "",
                static_cast<long long>(seconds < 0 ? -seconds : seconds),
                static_cast<long long>(rest < 0 ? -rest : rest));
  return text;
}

double ToSeconds(std::int64_t stamp_ns) {
  // Whole seconds and the rest separately: the nanoseconds of a Unix time do not fit the 53 bits of a double.
  const std::int64_t seconds = stamp_ns / kNsPerSecond;
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(stamp_ns % kNsPerSecond);
}

}  // namespace floorloc
