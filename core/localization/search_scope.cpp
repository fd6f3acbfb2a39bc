// SPDX-License-Identifier: Apache-2.0
#include "core/localization/search_scope.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace floorloc {
namespace {

// With a prior, every eighth keypoint usually finds the pose (all of them verify it); more are used when it does not.
constexpr std::array<int, 3> kStrides{8, 3, 1};

// Without a prior, few buckets of the index usually hold enough of the true neighbours.
constexpr int kFewProbes = 96;

// How far a keypoint can be from its predicted position when the pose is off by the prior's radii.
MatchGuide GuideOf(const PosePrior& prior, const RectM& roi) {
  const double lever = std::max(std::hypot(roi.x_min, roi.y_min), std::hypot(roi.x_max, roi.y_max));
  return {prior.map_from_base, prior.radius_m + prior.yaw_radius_rad * lever,
          prior.yaw_radius_rad + kKeypointAngleNoiseRad, 1};
}

}  // namespace

bool SearchScope::Contains(const Pose2& map_from_base) const {
  if (!prior) {
    return true;
  }
  const Pose2 off = prior->map_from_base.Between(map_from_base);
  return off.translation().norm() <= prior->radius_m && std::abs(off.yaw()) <= prior->yaw_radius_rad;
}

std::vector<SearchScope> SearchScopes(const std::optional<PosePrior>& prior, const RectM& roi, bool floor_repeats) {
  if (prior) {
    std::vector<SearchScope> scopes;
    SearchScope scope{prior, GuideOf(*prior, roi)};
    for (const int stride : kStrides) {
      scope.guide->stride = stride;
      scopes.push_back(scope);
    }
    return scopes;
  }
  if (floor_repeats) {
    return {SearchScope()};
  }
  SearchScope few;
  few.probes = kFewProbes;
  SearchScope indistinct;
  indistinct.indistinct = true;
  return {few, SearchScope(), indistinct};
}

SearchScope ThoroughScope(const std::optional<PosePrior>& prior, const RectM& roi) {
  SearchScope scope;
  scope.thorough = true;
  scope.indistinct = !prior;
  if (prior) {
    scope.prior = prior;
    scope.guide = GuideOf(*prior, roi);
  }
  return scope;
}

}  // namespace floorloc
