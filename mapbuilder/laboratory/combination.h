// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <string>
#include <utility>
#include <vector>

namespace floorloc {

enum class DetectorKind {
  kSurf,
  kSift,
  kOrb,
  kBrisk,
  kMser,
  kAkaze,
  kHarris,
  kShiTomasi,
  kFast,
  kStar,
  kContour,  ///< closed outlines of the thresholded image: shapes rather than points
};

enum class DescriptorKind {
  kSurf,
  kSift,
  kOrb,
  kBrisk,
  kFreak,
  kAkaze,
  kHu,  ///< the seven Hu moments of an outline
};

enum class MatcherKind { kBruteForce, kFlann };

/// How wrong matches are removed.
enum class MatchFilter { kNone, kRatio, kRansac, kRatioRansac };

/// One way from an image to a pose.
struct Combination {
  DetectorKind detector = DetectorKind::kSift;
  DescriptorKind descriptor = DescriptorKind::kSift;
  MatcherKind matcher = MatcherKind::kBruteForce;
  MatchFilter filter = MatchFilter::kRatioRansac;
  bool jump_filter = false;  ///< poses too far from the last accepted one are dropped

  auto operator<=>(const Combination&) const = default;
};

const char* ToString(DetectorKind kind);
const char* ToString(DescriptorKind kind);
const char* ToString(MatcherKind kind);
const char* ToString(MatchFilter filter);
/// "ratio + jump" and the like.
std::string FilterName(const Combination& combination);

/// A filter of the matches, with or without the jump filter: "ratio", "ransac+jump", ...
struct FilterChoice {
  MatchFilter filter = MatchFilter::kRatio;
  bool jump_filter = false;

  auto operator<=>(const FilterChoice&) const = default;
};

using DetectorDescriptor = std::pair<DetectorKind, DescriptorKind>;

/// What is to be combined: every pair with every matcher and every filter.
struct CombinationPlan {
  std::vector<DetectorDescriptor> pairs;
  std::vector<MatcherKind> matchers;
  std::vector<FilterChoice> filters;
};

/// Every detector with every descriptor. Contours and Hu moments are a method of their own: where they are among
/// others they only meet each other.
std::vector<DetectorDescriptor> PairAll(const std::vector<DetectorKind>& detectors,
                                        const std::vector<DescriptorKind>& descriptors);

/// Names as the user writes them, "all" among them; doubles count once. Throw std::invalid_argument that lists the
/// known names.
std::vector<DetectorKind> ParseDetectors(const std::vector<std::string>& names);
std::vector<DescriptorKind> ParseDescriptors(const std::vector<std::string>& names);
std::vector<MatcherKind> ParseMatchers(const std::vector<std::string>& names);
std::vector<FilterChoice> ParseFilters(const std::vector<std::string>& names);

/// Why the two cannot work together; empty when they can.
std::string IncompatibilityReason(DetectorKind detector, DescriptorKind descriptor);

}  // namespace floorloc
