// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/feature_group.h"

#include <array>
#include <cstddef>

namespace floorloc {
namespace {

struct GroupFacts {
  FeatureGroup group;
  std::string_view name;
  int size;
};

constexpr std::array<GroupFacts, kFeatureGroups> kFacts = {{
    {FeatureGroup::kHueSaturation, "hue-saturation", 16},
    {FeatureGroup::kValue, "value", 8},
    {FeatureGroup::kColor, "color", 12},
    {FeatureGroup::kDepthIntensity, "depth-intensity", 6},
    {FeatureGroup::kIntensity, "intensity", 25},
    {FeatureGroup::kShape, "shape", 14},
    {FeatureGroup::kPattern, "pattern", 30},
    {FeatureGroup::kGradient, "gradient", 15},
}};

const GroupFacts& FactsOf(FeatureGroup group) { return kFacts[static_cast<std::size_t>(group)]; }

}  // namespace

int GroupSize(FeatureGroup group) { return FactsOf(group).size; }

std::string_view GroupName(FeatureGroup group) { return FactsOf(group).name; }

std::optional<FeatureGroup> ParseGroup(std::string_view name) {
  for (const GroupFacts& facts : kFacts) {
    if (facts.name == name) {
      return facts.group;
    }
  }
  return std::nullopt;
}

bool NeedsRange(FeatureGroup group) {
  return group == FeatureGroup::kDepthIntensity || group == FeatureGroup::kIntensity;
}

std::vector<FeatureGroup> PaperGroups() {
  return {FeatureGroup::kHueSaturation, FeatureGroup::kValue, FeatureGroup::kColor, FeatureGroup::kDepthIntensity,
          FeatureGroup::kIntensity};
}

}  // namespace floorloc
