// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace floorloc {

/// Numbers as people read them: "12,345"; "0.42 mm", "3.1 cm", "2.50 m"; "0.85 m²", "1,240 m²"; "97 %", "0.4 %".
std::string NumberText(int number);
std::string LengthText(double length_m);
std::string AreaText(double area_m2);
std::string PercentText(double share);
/// A fixed number of decimals, "-0" avoided.
std::string FixedText(double value, int decimals);

/// The share-quantile of some values; 0 of none.
double Quantile(std::vector<double> values, double share);

}  // namespace floorloc
