// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/global_search.h"

#include <ctime>

namespace floorloc {
namespace {

// CPU time of this thread.
double ProcessorMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::vector<OrientedMatch> Oriented(const std::vector<Match>& matches, const Features& frame, const BigFloor& floor) {
  std::vector<OrientedMatch> oriented;
  oriented.reserve(matches.size());
  for (const Match& m : matches) {
    const Keypoint& from = frame.keypoints[static_cast<std::size_t>(m.query)];
    oriented.push_back({from.Position(), floor.Position(m.train), from.angle_rad, floor.AngleRad(m.train)});
  }
  return oriented;
}

}  // namespace

GlobalSearchResult SearchGlobally(const DescriptorIndex& index, const BigFloor& floor, const Features& frame,
                                  const GlobalSearchOptions& options) {
  const double start_ms = ProcessorMs();
  GlobalSearchResult result;
  for (const int effort : options.efforts) {
    result.effort = effort;
    result.matches = FindAllNear(index, frame.descriptors, {options.neighbours, options.max_distance, effort});
    const std::vector<OrientedMatch> matches = Oriented(result.matches, frame, floor);
    const std::vector<PoseCandidate> poses = FindPoseCandidates(matches, options.registration);
    const auto inliers = poses.empty() ? 0 : static_cast<int>(poses[0].inliers.size());
    if (inliers >= options.registration.min_inliers &&
        Log10NfaOfPose(static_cast<int>(matches.size()), inliers, {floor.area_m2()}, options.registration) <=
            options.max_log10_nfa) {
      result.floor_from_base = poses[0].target_from_source;
      break;
    }
  }
  result.ms = ProcessorMs() - start_ms;
  return result;
}

}  // namespace floorloc
