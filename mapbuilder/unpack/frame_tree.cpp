// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/frame_tree.h"

#include <algorithm>
#include <map>
#include <set>

namespace floorloc {

bool FrameTree::Contains(const std::string& frame) const {
  return std::any_of(transforms_.begin(), transforms_.end(),
                     [&](const FixedTransform& t) { return t.parent == frame || t.child == frame; });
}

std::optional<Eigen::Isometry3d> FrameTree::Find(const std::string& target, const std::string& source) const {
  std::map<std::string, Eigen::Isometry3d> target_from;  // of the frames that were reached
  std::vector<std::string> open{target};
  target_from[target] = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < open.size() && !target_from.contains(source); ++i) {
    const std::string frame = open[i];
    const auto reach = [&](const std::string& next, const Eigen::Isometry3d& frame_from_next) {
      if (target_from.try_emplace(next, target_from.at(frame) * frame_from_next).second) {
        open.push_back(next);
      }
    };
    for (const FixedTransform& t : transforms_) {
      if (t.parent == frame) {
        reach(t.child, t.parent_from_child);
      } else if (t.child == frame) {
        reach(t.parent, t.parent_from_child.inverse());
      }
    }
  }
  const auto found = target_from.find(source);
  return found == target_from.end() ? std::nullopt : std::optional(found->second);
}

std::string FrameTree::FindName(const std::string& name) const {
  if (Contains(name)) {
    return name;
  }
  std::set<std::string> found;
  for (const FixedTransform& t : transforms_) {
    for (const std::string& frame : {t.parent, t.child}) {
      if (frame.ends_with("/" + name)) {
        found.insert(frame);
      }
    }
  }
  return found.size() == 1 ? *found.begin() : std::string();
}

}  // namespace floorloc
