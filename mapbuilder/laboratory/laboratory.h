// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/run_summary.h"

namespace floorloc {

/// What is asked of the laboratory. What is left empty takes the default of the test.
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
  bool normalize = true;  ///< even out contrast; the thesis did not, its floor had enough
  std::optional<DetectorSettings> thresholds;
  std::optional<int> keypoints;  ///< budget per frame, and the same density in the map; 0: none
  std::optional<double> ratio;
  std::optional<PoseFit> fit;
  double inlier_radius_m = 0.003;
  int skip_frames = 0;
  int max_frames = 10;  ///< of each folder; 0: all
  Tolerance tolerance;
  JumpFilterOptions jump;
  std::uint32_t seed = 1;
  int threads = 0;
  ProgressOutput progress;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

struct LaboratoryReport {
  std::string title;
  std::vector<std::string> conditions;  ///< what was compared on what, and how to read it
  std::vector<ResultTable> tables;
  std::vector<RunSummary> summaries;  ///< over all bags; empty for tests 1 to 3
  double tolerance_mm = 0.0;
  double tolerance_deg = 0.0;
};

/// Runs the comparison or one of the thesis's tests. Throws InputError or std::invalid_argument.
LaboratoryReport RunLaboratory(const LaboratoryOptions& options);

}  // namespace floorloc
