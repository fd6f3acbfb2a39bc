// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/look_alike_folds.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

float SquaredDistance(const std::vector<float>& a, const std::vector<float>& b) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sum;
}

using Group = std::vector<std::size_t>;  // indices into looks

std::vector<float> MeanLook(const std::vector<std::vector<float>>& looks, const Group& group) {
  std::vector<float> mean(looks[group.front()].size(), 0.0F);
  for (const std::size_t member : group) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += looks[member][i] / static_cast<float>(group.size());
    }
  }
  return mean;
}

std::size_t FarthestFrom(const std::vector<float>& look, const std::vector<std::vector<float>>& looks,
                         const Group& group) {
  return *std::max_element(group.begin(), group.end(), [&](std::size_t a, std::size_t b) {
    return SquaredDistance(looks[a], look) < SquaredDistance(looks[b], look);
  });
}

// 2-means, from the picture that is farthest from the mean and the one that is farthest from that.
std::pair<Group, Group> Split(const std::vector<std::vector<float>>& looks, const Group& group) {
  constexpr int kIterations = 10;
  std::vector<float> first = looks[FarthestFrom(MeanLook(looks, group), looks, group)];
  std::vector<float> second = looks[FarthestFrom(first, looks, group)];
  std::pair<Group, Group> parts;
  for (int i = 0; i < kIterations; ++i) {
    parts = {};
    for (const std::size_t member : group) {
      const bool to_first = SquaredDistance(looks[member], first) < SquaredDistance(looks[member], second);
      (to_first ? parts.first : parts.second).push_back(member);
    }
    if (parts.first.empty() || parts.second.empty()) {
      return {{group.begin(), group.begin() + 1}, {group.begin() + 1, group.end()}};  // all look the same
    }
    first = MeanLook(looks, parts.first);
    second = MeanLook(looks, parts.second);
  }
  return parts;
}

// Splits the largest group until there are so many.
std::vector<Group> MakeGroups(const std::vector<std::vector<float>>& looks, const Group& members, std::size_t count) {
  std::vector<Group> groups = {members};
  while (groups.size() < count) {
    const auto largest = std::max_element(groups.begin(), groups.end(),
                                          [](const Group& a, const Group& b) { return a.size() < b.size(); });
    if (largest->size() < 2) {
      break;
    }
    std::pair<Group, Group> parts = Split(looks, *largest);
    *largest = std::move(parts.first);
    groups.push_back(std::move(parts.second));
  }
  return groups;
}

// The largest groups first, each to the fold that has the fewest pictures of the class.
void Deal(std::vector<Group> groups, std::size_t folds, std::vector<int>* fold_of) {
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<std::size_t> sizes(folds, 0);
  for (const Group& group : groups) {
    const auto fold = std::min_element(sizes.begin(), sizes.end());
    *fold += group.size();
    for (const std::size_t picture : group) {
      (*fold_of)[picture] = static_cast<int>(fold - sizes.begin());
    }
  }
}

}  // namespace

void FoldOptions::Check() const {
  RequireOption(folds >= 2 && folds <= 1000, "folds must be 2 to 1000");
  RequireOption(pictures_per_group >= 1, "pictures_per_group must be 1 or more");
}

std::vector<int> LookAlikeFolds(const std::vector<std::vector<float>>& looks, std::span<const int> labels,
                                const FoldOptions& options) {
  options.Check();
  std::vector<int> fold_of(looks.size(), 0);
  const auto folds = static_cast<std::size_t>(options.folds);
  const int classes = labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + 1;
  for (int c = 0; c < classes; ++c) {
    Group members;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (labels[i] == c) {
        members.push_back(i);
      }
    }
    const std::size_t wanted = members.size() / static_cast<std::size_t>(options.pictures_per_group);
    Deal(MakeGroups(looks, members, std::max(wanted, 2 * folds)), folds, &fold_of);
  }
  return fold_of;
}

}  // namespace floorloc
