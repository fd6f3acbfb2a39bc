// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fault_table.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace floorloc {
namespace {

std::string Short(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

std::string Cell(const FaultScore& score) {
  const double frames = static_cast<double>(std::max<std::size_t>(score.frames, 1));
  const double nees = Median(score.nees);
  std::ostringstream text;
  text << Short(100.0 * static_cast<double>(score.good) / frames, 1) << "; "
       << (nees < 1000.0 ? Short(nees, 1) : "> 1000") << "; " << score.longest_wrong_run << "; "
       << Short(1000.0 * RootMeanSquare(score.between), 0);
  return text.str();
}

}  // namespace

std::vector<FusionVariant> AllFaultVariants() {
  PoseFilterOptions trusting;
  trusting.monitor.enabled = false;
  FusionVariant blind{"no wheels", FusionMethod::kEkf};
  blind.uses_wheels = false;
  return {{"last fix held", FusionMethod::kFixes},
          blind,
          {"before: wheels", FusionMethod::kEkf, false, false, trusting},
          {"before: + IMU", FusionMethod::kEkf, false, true, trusting},
          {"wheels", FusionMethod::kEkf},
          {"+ IMU", FusionMethod::kEkf, false, true},
          {"+ images' motion", FusionMethod::kEkf, true, true}};
}

void PrintFaultTable(std::ostream& out, const std::vector<FusionVariant>& variants, const std::vector<FaultRow>& rows) {
  out << "| fault | images per s |";
  for (const FusionVariant& variant : variants) {
    out << " " << variant.name << " |";
  }
  out << "\n|---|---:|";
  for (std::size_t i = 0; i < variants.size(); ++i) {
    out << "---:|";
  }
  out << "\n";
  for (const FaultRow& row : rows) {
    out << "| " << row.fault << " | " << row.images_per_s << " |";
    for (const FaultScore& score : row.scores) {
      out << " " << Cell(score) << " |";
    }
    out << "\n";
  }
  out << "\nFrom " << kFaultSettleS
      << " s after the onset on. Answers to images that are \"localized\" and within 10 mm, %; median NEES of\n"
         "those that claim a pose (2.4 is exact); longest run of them that is off by more than five standard "
         "deviations;\nRMSE between the images, mm.\n";
}

}  // namespace floorloc
