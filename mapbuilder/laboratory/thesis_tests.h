// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/run_summary.h"

namespace floorloc {

// The tests of chapter 4 of N. Napoleao's thesis on feature matching for robotic localization (University of Porto),
// with its columns, on any floor.

/// Test 1: number of features that each detector finds in the map.
ResultTable CountFeatures(const FloorImage& map, const std::vector<DetectorKind>& detectors,
                          const ExperimentOptions& options);

/// Test 2: number of matches between the map and one of its frames that pass the ratio test; FLANN's are means over ten
/// seeds.
ResultTable CountMatches(const FloorImage& map, const TestFrame& frame, const CombinationPlan& plan,
                         const ExperimentOptions& options);

/// Test 3: the ratio that maximises right minus wrong matches, for each pair (brute force). Judged by the true poses
/// here, by eye in the thesis.
ResultTable FindBestRatios(const FloorImage& map, const std::vector<FrameBag>& bags,
                           const std::vector<DetectorDescriptor>& pairs, const ExperimentOptions& options);

/// Test 4: the nine parameters of every combination in every bag.
ResultTable CompareStills(const std::vector<RunSummary>& summaries);

/// Detectors and descriptors of the thesis, and the pairs used in its test 4.
std::vector<DetectorKind> ThesisDetectors();
std::vector<DescriptorKind> ThesisDescriptors();
CombinationPlan ThesisStillsPlan();

}  // namespace floorloc
