// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/readout_finding.h"

#include <cmath>
#include <cstdio>

namespace floorloc {
namespace {

ReadoutDirection Opposite(ReadoutDirection direction) {
  switch (direction) {
    case ReadoutDirection::kDown:
      return ReadoutDirection::kUp;
    case ReadoutDirection::kUp:
      return ReadoutDirection::kDown;
    case ReadoutDirection::kRight:
      return ReadoutDirection::kLeft;
    case ReadoutDirection::kLeft:
      break;
  }
  return ReadoutDirection::kRight;
}

}  // namespace

std::vector<Finding> FindingsOfReadout(const Readout& given, const std::optional<ReadoutMeasurement>& learnt) {
  if (given.seconds || !learnt) {
    return {};
  }
  char text[128];
  const double sigma_ms = 1e3 * learnt->sigma_s;
  constexpr double kSignificant = 3.0;
  if (std::abs(learnt->seconds) <= kSignificant * learnt->sigma_s) {
    std::snprintf(text, sizeof(text), "no read-out row by row was seen: %.1f +- %.1f ms",
                  1e3 * std::abs(learnt->seconds), sigma_ms);
    return {{"camera", FindingStatus::kOk, text, ""}};
  }
  const ReadoutDirection direction = learnt->seconds > 0.0 ? given.direction : Opposite(given.direction);
  std::snprintf(text, sizeof(text), "images seem to be read out %s by %s in %.1f +- %.1f ms",
                given.ByColumns() ? "column" : "row", given.ByColumns() ? "column" : "row",
                1e3 * std::abs(learnt->seconds), sigma_ms);
  char cure[128];
  std::snprintf(cure, sizeof(cure), "write 'readout_s: %.4f' and 'readout_direction: %s' into camera.yaml",
                std::abs(learnt->seconds), ToString(direction));
  return {{"camera", FindingStatus::kNote, text, cure}};
}

}  // namespace floorloc
