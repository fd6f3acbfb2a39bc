// SPDX-License-Identifier: Apache-2.0
#include "server/wire/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace floorloc {

std::optional<double> ParseFinite(std::string_view text) {
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = result.ec == std::errc() && result.ptr == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<double> ParseNumberList(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::optional<double> value = ParseFinite(text.substr(start, end - start));
    if (!value) {
      return {};
    }
    numbers.push_back(*value);
    start = end + 1;
  }
  return numbers;
}

}  // namespace floorloc
