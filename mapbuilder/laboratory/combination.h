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
  kContour,  ///< closed contours of the thresholded image: shapes rather than points
};

enum class DescriptorKind {
  kSurf,
  kSift,
  kOrb,
  kBrisk,
  kFreak,
  kAkaze,
  kHu,  ///< the seven Hu moments of a contour
};

enum class MatcherKind { kBruteForce, kFlann };

/// Outlier removal from the matches.
enum class MatchFilter { kNone, kRatio, kRansac, kRatioRansac };

/// One pipeline from an image to a pose.
struct Combination {
  DetectorKind detector = DetectorKind::kSift;
  DescriptorKind descriptor = DescriptorKind::kSift;
  MatcherKind matcher = MatcherKind::kBruteForce;
  MatchFilter filter = MatchFilter::kRatioRansac;
  bool jump_filter = false;  ///< drops poses too far from the last accepted one

  auto operator<=>(const Combination&) const = default;
};

const char* ToString(DetectorKind kind);
const char* ToString(DescriptorKind kind);
const char* ToString(MatcherKind kind);
const char* ToString(MatchFilter filter);
/// E.g. "ratio + jump".
std::string FilterName(const Combination& combination);

/// A match filter, with or without the jump filter: "ratio", "ransac+jump", ...
struct FilterChoice {
  MatchFilter filter = MatchFilter::kRatio;
  bool jump_filter = false;

  auto operator<=>(const FilterChoice&) const = default;
};

using DetectorDescriptor = std::pair<DetectorKind, DescriptorKind>;

/// Pairs, matchers and filters, to be combined exhaustively.
struct CombinationPlan {
  std::vector<DetectorDescriptor> pairs;
  std::vector<MatcherKind> matchers;
  std::vector<FilterChoice> filters;
};

/// Pairs every detector with every descriptor. Contours and Hu moments form a method of their own: if there are other
/// kinds, they are only paired with each other.
std::vector<DetectorDescriptor> PairAll(const std::vector<DetectorKind>& detectors,
                                        const std::vector<DescriptorKind>& descriptors);

/// Parse names given by the user, including "all"; duplicates count once. Throw std::invalid_argument that lists the
/// known names.
std::vector<DetectorKind> ParseDetectors(const std::vector<std::string>& names);
std::vector<DescriptorKind> ParseDescriptors(const std::vector<std::string>& names);
std::vector<MatcherKind> ParseMatchers(const std::vector<std::string>& names);
std::vector<FilterChoice> ParseFilters(const std::vector<std::string>& names);

/// Reason why the two cannot be combined; empty when they can.
std::string IncompatibilityReason(DetectorKind detector, DescriptorKind descriptor);

}  // namespace floorloc
