// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace floorloc {

/// Formatted numbers: "12,345"; "0.42 mm", "3.1 cm", "2.50 m"; "0.85 m²", "1,240 m²"; "97 %", "0.4 %".
std::string NumberText(int number);
std::string LengthText(double length_m);
std::string AreaText(double area_m2);
std::string PercentText(double share);
/// Fixed number of decimals; never "-0".
std::string FixedText(double value, int decimals);

/// Quantile at `share` (0 ... 1); 0 for no values.
double Quantile(std::vector<double> values, double share);

}  // namespace floorloc
