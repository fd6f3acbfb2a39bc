// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace floorloc {

/// A transform of /tf_static, or one of /tf that never changed: parent_from_child.
struct FixedTransform {
  std::string parent;
  std::string child;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
};

/// The coordinate frames of a robot that do not move against each other.
class FrameTree {
 public:
  explicit FrameTree(std::vector<FixedTransform> transforms) : transforms_(std::move(transforms)) {}

  bool Contains(const std::string& frame) const;
  /// target_from_source along the transforms and their inverses; empty when they do not connect the two.
  std::optional<Eigen::Isometry3d> Find(const std::string& target, const std::string& source) const;
  /// The frame of this name, or the only one of this name behind a prefix ("robot1/base_link"); empty: none.
  std::string FindName(const std::string& name) const;

 private:
  std::vector<FixedTransform> transforms_;
};

}  // namespace floorloc
