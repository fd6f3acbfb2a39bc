// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/number_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace floorloc {

std::string FixedText(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  const std::string fixed = text;
  return fixed.find_first_not_of("-0.") == std::string::npos && fixed.front() == '-' ? fixed.substr(1) : fixed;
}

std::string NumberText(int number) {
  std::string digits = std::to_string(number);
  const std::ptrdiff_t first = number < 0 ? 1 : 0;
  for (auto index = static_cast<std::ptrdiff_t>(digits.size()) - 3; index > first; index -= 3) {
    digits.insert(static_cast<std::size_t>(index), ",");
  }
  return digits;
}

std::string LengthText(double length_m) {
  if (length_m < 0.00995) {
    return FixedText(1e3 * length_m, 2) + " mm";
  }
  return length_m < 0.995 ? FixedText(1e2 * length_m, 1) + " cm" : FixedText(length_m, 2) + " m";
}

std::string AreaText(double area_m2) {
  return (area_m2 < 99.95 ? FixedText(area_m2, area_m2 < 9.995 ? 2 : 1)
                          : NumberText(static_cast<int>(std::lround(area_m2)))) +
         " m²";
}

std::string PercentText(double share) { return FixedText(1e2 * share, share > 0.0 && share < 0.095 ? 1 : 0) + " %"; }

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto index = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

}  // namespace floorloc
