// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/localization/localizer.h"
#include "tests/bench/scenes/cases.h"

namespace floorloc {

/// Where a frame is taken.
enum class FramePlace {
  kMap,         ///< entirely on the surveyed floor
  kEdge,        ///< across the border of the surveyed floor
  kUnmapped,    ///< on the unsurveyed part of the same floor
  kOtherFloor,  ///< on another floor
};
/// "map", "edge", "unmapped", "other_floor"
const char* ToString(FramePlace place);
/// Throws std::invalid_argument for another name.
FramePlace ParseFramePlace(const std::string& name);

/// Kind of prior that the localizer gets.
enum class SearchKind {
  kGlobal,      ///< no prior
  kPrior,       ///< a correct prior
  kWrongPrior,  ///< a prior that excludes the truth: one repetition off, or on the map although the frame is not
};
/// "global", "prior", "wrong_prior"
const char* ToString(SearchKind search);
/// Throws std::invalid_argument for another name.
SearchKind ParseSearchKind(const std::string& name);

/// One call of the localizer.
struct PlannedSearch {
  SearchKind kind = SearchKind::kGlobal;
  std::optional<PosePrior> prior;  ///< its pose is truth_from_base
};

/// A prior with an error uniform over its allowed range. Its pose is truth_from_base.
PosePrior DrawPrior(const Pose2& truth_from_base, cv::RNG& rng);

/// One frame of the benchmark. All its random values derive from its seed.
struct FramePlan {
  FramePlace place = FramePlace::kMap;
  std::size_t condition = 0;    ///< index of the condition case
  std::size_t other_floor = 0;  ///< 0 ... others - 1, when it is on another floor
  Pose2 truth_from_base;        ///< in the frame of the floor that the image shows
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  double time_s = 0.0;
  std::uint64_t seed = 0;
  std::vector<PlannedSearch> searches;
};

/// Draws the frames of a floor.
struct FramePlanner {
  FloorCase floor;
  RectM roi;                   ///< of the camera
  std::size_t conditions = 1;  ///< number of condition cases
  std::vector<Eigen::Vector2d> other_sizes_m;
  std::uint64_t seed = 1;
  bool only_on_map = false;  ///< all frames are FramePlace::kMap; then the floor needs no unmapped part

  /// Deterministic: equal frame numbers give equal plans.
  FramePlan Plan(int frame) const;
};

}  // namespace floorloc
