// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/combination.h"

#include <algorithm>
#include <stdexcept>

#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

template <typename Kind>
using NameTable = std::vector<std::pair<std::string, Kind>>;

const NameTable<DetectorKind>& DetectorNames() {
  static const NameTable<DetectorKind> names = {
      {"surf", DetectorKind::kSurf},      {"sift", DetectorKind::kSift},
      {"orb", DetectorKind::kOrb},        {"brisk", DetectorKind::kBrisk},
      {"mser", DetectorKind::kMser},      {"akaze", DetectorKind::kAkaze},
      {"harris", DetectorKind::kHarris},  {"shi-tomasi", DetectorKind::kShiTomasi},
      {"fast", DetectorKind::kFast},      {"star", DetectorKind::kStar},
      {"contour", DetectorKind::kContour}};
  return names;
}

const NameTable<DescriptorKind>& DescriptorNames() {
  static const NameTable<DescriptorKind> names = {{"surf", DescriptorKind::kSurf},   {"sift", DescriptorKind::kSift},
                                                  {"orb", DescriptorKind::kOrb},     {"brisk", DescriptorKind::kBrisk},
                                                  {"freak", DescriptorKind::kFreak}, {"akaze", DescriptorKind::kAkaze},
                                                  {"hu", DescriptorKind::kHu}};
  return names;
}

const NameTable<MatcherKind>& MatcherNames() {
  static const NameTable<MatcherKind> names = {{"brute-force", MatcherKind::kBruteForce},
                                               {"flann", MatcherKind::kFlann}};
  return names;
}

const NameTable<MatchFilter>& MatchFilterNames() {
  static const NameTable<MatchFilter> names = {{"none", MatchFilter::kNone},
                                               {"ratio", MatchFilter::kRatio},
                                               {"ransac", MatchFilter::kRansac},
                                               {"ratio+ransac", MatchFilter::kRatioRansac}};
  return names;
}

NameTable<FilterChoice> FilterChoices() {
  NameTable<FilterChoice> choices;
  for (const bool jump : {false, true}) {
    for (const auto& [name, filter] : MatchFilterNames()) {
      choices.push_back({jump ? name + "+jump" : name, {filter, jump}});
    }
  }
  return choices;
}

template <typename Kind>
const char* NameOf(const NameTable<Kind>& names, Kind kind) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.second == kind; });
  return found == names.end() ? "?" : found->first.c_str();
}

template <typename Kind>
[[noreturn]] void ThrowUnknown(const std::string& what, const std::string& name, const NameTable<Kind>& known) {
  std::string list = "all";
  std::for_each(known.begin(), known.end(), [&](const auto& entry) { list.append(", ").append(entry.first); });
  throw std::invalid_argument("unknown " + what + " '" + name + "'; known are: " + list);
}

template <typename Kind>
std::vector<Kind> Parse(const NameTable<Kind>& known, const std::vector<std::string>& names, const std::string& what) {
  std::vector<Kind> kinds;
  const auto add = [&](Kind kind) {
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      kinds.push_back(kind);
    }
  };
  for (const std::string& name : names) {
    const auto found = std::find_if(known.begin(), known.end(), [&](const auto& entry) { return entry.first == name; });
    if (found != known.end()) {
      add(found->second);
    } else if (name == "all") {
      std::for_each(known.begin(), known.end(), [&](const auto& entry) { add(entry.second); });
    } else {
      ThrowUnknown(what, name, known);
    }
  }
  return kinds;
}

bool SurfIsBuilt() {
  try {
    const Surf surf{SurfOptions()};
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

}  // namespace

const char* ToString(DetectorKind kind) { return NameOf(DetectorNames(), kind); }
const char* ToString(DescriptorKind kind) { return NameOf(DescriptorNames(), kind); }
const char* ToString(MatcherKind kind) { return NameOf(MatcherNames(), kind); }
const char* ToString(MatchFilter filter) { return NameOf(MatchFilterNames(), filter); }

std::string FilterName(const Combination& combination) {
  return std::string(ToString(combination.filter)) + (combination.jump_filter ? "+jump" : "");
}

std::vector<DetectorDescriptor> PairAll(const std::vector<DetectorKind>& detectors,
                                        const std::vector<DescriptorKind>& descriptors) {
  std::vector<DetectorDescriptor> pairs;
  for (const DetectorKind detector : detectors) {
    for (const DescriptorKind descriptor : descriptors) {
      const bool shape = detector == DetectorKind::kContour && descriptor == DescriptorKind::kHu;
      const bool half_shape = detector == DetectorKind::kContour || descriptor == DescriptorKind::kHu;
      if (shape || !half_shape) {
        pairs.emplace_back(detector, descriptor);
      }
    }
  }
  return pairs;
}

std::vector<DetectorKind> ParseDetectors(const std::vector<std::string>& names) {
  return Parse(DetectorNames(), names, "detector");
}
std::vector<DescriptorKind> ParseDescriptors(const std::vector<std::string>& names) {
  return Parse(DescriptorNames(), names, "descriptor");
}
std::vector<MatcherKind> ParseMatchers(const std::vector<std::string>& names) {
  return Parse(MatcherNames(), names, "matcher");
}
std::vector<FilterChoice> ParseFilters(const std::vector<std::string>& names) {
  return Parse(FilterChoices(), names, "filter");
}

std::string IncompatibilityReason(DetectorKind detector, DescriptorKind descriptor) {
  if ((detector == DetectorKind::kContour) != (descriptor == DescriptorKind::kHu)) {
    return "Hu moments describe contours, and only they do";
  }
  if (descriptor == DescriptorKind::kAkaze && detector != DetectorKind::kAkaze) {
    return "AKAZE describes only keypoints of its own scale space";
  }
  if ((detector == DetectorKind::kSurf || descriptor == DescriptorKind::kSurf) && !SurfIsBuilt()) {
    return "SURF was left out of this build";
  }
  return "";
}

}  // namespace floorloc
