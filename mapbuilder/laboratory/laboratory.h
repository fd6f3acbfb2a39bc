// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/run_summary.h"

namespace floorloc {

/// Options of the laboratory. Empty fields take the default of the test.
struct LaboratoryOptions {
  std::filesystem::path survey;
  std::vector<std::filesystem::path> frames;
  int thesis_test = 0;  ///< 1 to 4; 0: the comparison
  std::vector<DetectorKind> detectors;
  std::vector<DescriptorKind> descriptors;
  std::vector<MatcherKind> matchers;
  std::vector<FilterChoice> filters;
  bool features = true;   ///< compare detectors and descriptors
  bool contours = true;   ///< compare contour matching too
  bool templates = true;  ///< compare template matching too
  bool normalize = true;  ///< normalise contrast; not done in the thesis, whose floor had enough
  std::optional<DetectorSettings> thresholds;
  std::optional<int> keypoints;  ///< budget per frame, with the same density in the map; 0: unlimited
  std::optional<double> ratio;
  std::optional<PoseFit> fit;
  double inlier_radius_m = 0.003;
  int skip_frames = 0;
  int max_frames = 10;  ///< per folder; 0: all
  Tolerance tolerance;
  JumpFilterOptions jump;
  std::uint32_t seed = 1;
  RunOptions run;

  /// Throws std::invalid_argument when a field is out of range.
  void Check() const;
};

struct LaboratoryReport {
  std::string title;
  std::vector<std::string> conditions;  ///< what was compared on which data, and how to read it
  std::vector<ResultTable> tables;
  std::vector<RunSummary> summaries;  ///< over all bags; empty for tests 1 to 3
  double tolerance_mm = 0.0;
  double tolerance_deg = 0.0;
};

/// Runs the comparison or one of the thesis's tests. Throws InputError or std::invalid_argument.
LaboratoryReport RunLaboratory(const LaboratoryOptions& options);

}  // namespace floorloc
