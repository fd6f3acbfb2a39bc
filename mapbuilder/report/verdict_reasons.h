// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/build/build_report.h"
#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// Reasons by severity: those that make the map unusable, and those to inspect.
struct VerdictReasons {
  std::vector<std::string> severe, mild;

  void Add(bool is_severe, const std::string& sentence) { (is_severe ? severe : mild).push_back(sentence); }
};

/// What the images say of the cameras. True: it alone makes the map unusable.
bool AssessCameras(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons);

/// Whether images alone told the order of a floor that repeats itself. True: they did not tell that of most frames.
bool AssessRepetition(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons);

}  // namespace floorloc
