// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/join_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mapbuilder/spanning_forest.h"

namespace floorloc {
namespace {

// Two links tell the same story when they place the parts this near to each other.
constexpr double kSameM = 0.05;
constexpr double kSameRad = 0.05;

// The best story must have this many times the inliers of the second best.
constexpr double kMinLead = 1.5;

// Parts of several frames are only joined by several links.
constexpr int kSmallPart = 3;
constexpr std::size_t kMinLinks = 2;

// One way to place two parts to each other, with the links that agree with it.
struct Story {
  Pose2 first_from_second;  // of the parts' frames
  std::vector<Link> links;
  int inliers = 0;
};

struct PartPair {
  int first = 0;
  int second = 0;
  auto operator<=>(const PartPair&) const = default;
};

bool Agree(const Pose2& a, const Pose2& b) {
  const Pose2 d = a.Between(b);
  return d.translation().norm() < kSameM && std::abs(d.yaw()) < kSameRad;
}

void AddToStories(const Pose2& first_from_second, const Link& link, std::vector<Story>* stories) {
  auto story = std::find_if(stories->begin(), stories->end(),
                            [&](const Story& s) { return Agree(s.first_from_second, first_from_second); });
  if (story == stories->end()) {
    story = stories->insert(stories->end(), {first_from_second, {}, 0});
  }
  story->links.push_back(link);
  story->inliers += link.inliers;
}

std::map<PartPair, std::vector<Story>> CollectStories(const std::vector<Pose2>& part_from_base,
                                                      const std::vector<int>& part,
                                                      const std::vector<Link>& candidates) {
  std::map<PartPair, std::vector<Story>> stories;
  for (const Link& link : candidates) {
    const auto i = static_cast<std::size_t>(link.first);
    const auto j = static_cast<std::size_t>(link.second);
    const Pose2 between = part_from_base[i] * link.first_from_second * part_from_base[j].Inverse();
    if (part[i] < part[j]) {
      AddToStories(between, link, &stories[{part[i], part[j]}]);
    } else if (part[i] > part[j]) {
      AddToStories(between.Inverse(), link, &stories[{part[j], part[i]}]);
    }
  }
  return stories;
}

// The story to believe about two parts, or none.
const Story* Believable(const std::vector<Story>& stories, int smaller_part_size) {
  const auto by_inliers = [](const Story& a, const Story& b) { return a.inliers < b.inliers; };
  const auto best = std::max_element(stories.begin(), stories.end(), by_inliers);
  for (auto s = stories.begin(); s != stories.end(); ++s) {
    if (s != best && kMinLead * s->inliers > best->inliers) {
      return nullptr;
    }
  }
  const bool enough = best->links.size() >= kMinLinks || smaller_part_size < kSmallPart;
  return enough ? &*best : nullptr;
}

}  // namespace

std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates) {
  std::vector<Link> trusted = links;
  std::vector<Link> joining;
  while (true) {
    const std::vector<int> part = FindComponents(frame_count, trusted);
    std::map<int, int> size;
    for (const int p : part) {
      ++size[p];
    }
    const std::vector<Pose2> poses = ChainPoses(std::vector<Pose2>(static_cast<std::size_t>(frame_count)), trusted, {});
    const auto stories = CollectStories(poses, part, candidates);
    const Story* best = nullptr;
    for (const auto& [pair, list] : stories) {
      const Story* story = Believable(list, std::min(size[pair.first], size[pair.second]));
      if (story != nullptr && (best == nullptr || story->inliers > best->inliers)) {
        best = story;
      }
    }
    if (best == nullptr) {
      return joining;
    }
    joining.insert(joining.end(), best->links.begin(), best->links.end());
    trusted.insert(trusted.end(), best->links.begin(), best->links.end());
  }
}

}  // namespace floorloc
