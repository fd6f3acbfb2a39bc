// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/spanning_forest.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <queue>

namespace floorloc {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  int Find(int i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      int& parent = parent_[static_cast<std::size_t>(i)];
      parent = parent_[static_cast<std::size_t>(parent)];
      i = parent;
    }
    return i;
  }
  /// Returns false if already joined. The smaller number becomes the root.
  bool Join(int a, int b) {
    a = Find(a);
    b = Find(b);
    if (a == b) {
      return false;
    }
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    return true;
  }

 private:
  std::vector<int> parent_;
};

struct Edge {
  int to = 0;
  Pose2 from_from_to;
};

std::vector<std::vector<Edge>> BuildForest(std::size_t frame_count, const std::vector<Link>& links,
                                           const std::vector<Link>& odometry) {
  std::vector<const Link*> ordered;
  for (const Link& link : links) {
    ordered.push_back(&link);
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Link* a, const Link* b) { return a->inliers > b->inliers; });
  for (const Link& link : odometry) {
    ordered.push_back(&link);
  }
  DisjointSets sets(frame_count);
  std::vector<std::vector<Edge>> edges(frame_count);
  for (const Link* link : ordered) {
    if (sets.Join(link->first, link->second)) {
      edges[static_cast<std::size_t>(link->first)].push_back({link->second, link->first_from_second});
      edges[static_cast<std::size_t>(link->second)].push_back({link->first, link->first_from_second.Inverse()});
    }
  }
  return edges;
}

}  // namespace

std::vector<int> FindComponents(int frame_count, const std::vector<Link>& links) {
  DisjointSets sets(static_cast<std::size_t>(frame_count));
  for (const Link& link : links) {
    sets.Join(link.first, link.second);
  }
  std::map<int, int> number;
  std::vector<int> component;
  for (int i = 0; i < frame_count; ++i) {
    component.push_back(number.try_emplace(sets.Find(i), static_cast<int>(number.size())).first->second);
  }
  return component;
}

std::vector<Pose2> ChainPoses(const std::vector<Pose2>& root_pose, const std::vector<Link>& links,
                              const std::vector<Link>& odometry) {
  const auto edges = BuildForest(root_pose.size(), links, odometry);
  std::vector<Pose2> poses = root_pose;
  std::vector<bool> placed(root_pose.size(), false);
  for (std::size_t root = 0; root < root_pose.size(); ++root) {
    if (placed[root]) {
      continue;
    }
    placed[root] = true;
    std::queue<std::size_t> open({root});
    while (!open.empty()) {
      const std::size_t from = open.front();
      open.pop();
      for (const Edge& edge : edges[from]) {
        const auto to = static_cast<std::size_t>(edge.to);
        if (!placed[to]) {
          placed[to] = true;
          poses[to] = poses[from] * edge.from_from_to;
          open.push(to);
        }
      }
    }
  }
  return poses;
}

}  // namespace floorloc
