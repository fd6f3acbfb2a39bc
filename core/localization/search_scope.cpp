// SPDX-License-Identifier: Apache-2.0
#include "core/localization/search_scope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// With a prior, every eighth keypoint usually finds the pose (all of them verify it); more are used when it does not.
constexpr std::array<int, 3> kStrides{8, 3, 1};
// Upright descriptors match more often, and have more to be compared with.
constexpr std::array<int, 3> kUprightStrides{16, 4, 1};

// Without a prior, few buckets of the index usually hold enough of the true neighbours.
constexpr int kFewProbes = 96;

// Distance of the farthest visible floor from the base.
double Lever(const RectM& roi) { return std::max(std::hypot(roi.x_min, roi.y_min), std::hypot(roi.x_max, roi.y_max)); }

// How far a keypoint can be from its predicted position when the pose is off by the prior's radii.
MatchGuide GuideOf(const PosePrior& prior, const RectM& roi) {
  return {prior.map_from_base, prior.radius_m + prior.yaw_radius_rad * Lever(roi),
          prior.yaw_radius_rad + kKeypointAngleNoiseRad, 1};
}

// Headings no farther apart than the step, about the middle of a range.
std::vector<double> HeadingsAround(double middle_rad, double half_range_rad, double step_rad) {
  const int count = std::max(1, static_cast<int>(std::ceil(2.0 * half_range_rad / step_rad)));
  const double width = 2.0 * half_range_rad / count;
  std::vector<double> headings;
  for (int i = 0; i < count; ++i) {
    headings.push_back(middle_rad - half_range_rad + (i + 0.5) * width);
  }
  return headings;
}

SearchScope ScopeOf(const PosePrior& prior, const RectM& roi, const SearchableMap& map, const SearchOptions& options) {
  SearchScope scope{prior, GuideOf(prior, roi)};
  if (map.upright) {
    scope.headings = HeadingsAround(prior.map_from_base.yaw(), prior.yaw_radius_rad, options.heading_step_rad);
    // What is left of the uncertain heading beside the nearest of these.
    const double yaw_radius_rad = prior.yaw_radius_rad / static_cast<double>(scope.headings.size());
    scope.guide->radius_m = prior.radius_m + yaw_radius_rad * Lever(roi);
  }
  return scope;
}

// The whole map, at every heading: all near neighbours vote.
SearchScope AllHeadings(double step_rad, int strongest) {
  SearchScope scope;
  scope.indistinct = true;
  scope.headings = HeadingsAround(0.0, std::numbers::pi, step_rad);
  scope.strongest = strongest;
  return scope;
}

}  // namespace

bool SearchScope::Contains(const Pose2& map_from_base) const {
  if (!prior) {
    return true;
  }
  const Pose2 off = prior->map_from_base.Between(map_from_base);
  return off.translation().norm() <= prior->radius_m && std::abs(off.yaw()) <= prior->yaw_radius_rad;
}

bool SearchScope::IsUnquestioned(const SearchOptions& options) const {
  return prior && prior->p_elsewhere && *prior->p_elsewhere <= options.unquestioned_p_elsewhere;
}

double SearchScope::WeightOutside(const SearchOptions& options) const {
  return prior && !prior->p_elsewhere ? options.prior_failure_rate : 1.0;
}

std::vector<SearchScope> SearchScopes(const std::optional<PosePrior>& prior, const RectM& roi, const SearchableMap& map,
                                      const SearchOptions& options) {
  if (prior) {
    std::vector<SearchScope> scopes;
    SearchScope scope = ScopeOf(*prior, roi, map, options);
    for (const int stride : map.upright ? kUprightStrides : kStrides) {
      scope.guide->stride = stride;
      scopes.push_back(scope);
    }
    return scopes;
  }
  if (map.floor_repeats) {
    return {SearchScope()};
  }
  SearchScope few;
  few.probes = kFewProbes;
  SearchScope indistinct;
  indistinct.indistinct = true;
  if (!map.upright) {
    return {few, SearchScope(), indistinct};
  }
  return {few, SearchScope(), AllHeadings(options.heading_step_rad, options.heading_keypoints), indistinct};
}

SearchScope ModuloScope(const FloorLattice& lattice, const SearchableMap& map, const SearchOptions& options) {
  SearchScope scope;
  scope.indistinct = true;
  if (map.upright) {
    scope = AllHeadings(options.heading_step_rad, options.modulo_keypoints);
  }
  scope.modulo = lattice;
  return scope;
}

SearchScope ThoroughScope(const std::optional<PosePrior>& prior, const RectM& roi, const SearchableMap& map,
                          const SearchOptions& options) {
  SearchScope scope;
  if (prior) {
    scope = ScopeOf(*prior, roi, map, options);
  } else if (map.upright) {
    scope = AllHeadings(options.heading_step_rad, options.thorough_heading_keypoints);
  } else {
    scope.indistinct = true;
  }
  scope.thorough = true;
  return scope;
}

}  // namespace floorloc
