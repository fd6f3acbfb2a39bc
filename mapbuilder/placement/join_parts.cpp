// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/join_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// Two links tell the same story when they put a frame this near to the same place; a share of their distance from each
// other comes on top, for the drift between them.
constexpr double kSameM = 0.05;
constexpr double kSameShare = 0.03;
constexpr double kSameRad = 0.06;

// The best story must have this many times the evidence of the second best.
constexpr double kMinLead = 1.5;

// Parts of several frames are only joined by several links, on floors that repeat themselves all parts.
constexpr std::size_t kSmallPart = 3;
constexpr std::size_t kMinLinks = 2;

// More links with a rival than this: the floor repeats itself.
constexpr double kRepeatingShare = 0.2;

// On floors that repeat themselves, links count from this share of the usual agreement of true ones on.
constexpr double kMinAgreementShare = 0.85;

// The agreement of true links: what the best link of every frame reaches, in the median.
double UsualAgreement(const std::vector<Link>& candidates) {
  std::map<int, double> best;
  for (const Link& link : candidates) {
    for (const int frame : {link.first, link.second}) {
      double& so_far = best[frame];
      so_far = std::max(so_far, link.agreement);
    }
  }
  std::vector<double> values;
  for (const auto& [frame, agreement] : best) {
    values.push_back(agreement);
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What a link's agreement says: its inliers count fully on floors that do not repeat themselves. On those that do,
// look- alike places agree nearly as well as true ones, and what agrees clearly less than usual speaks against a join.
class LinkEvidence {
 public:
  explicit LinkEvidence(const std::vector<Link>& candidates)
      : least_(FloorRepeats(candidates) ? MinAgreement(candidates) : 0.0) {}

  bool DoubtsSingleLinks() const { return least_ > 0.0; }
  double Of(const Link& link) const {
    if (least_ <= 0.0) {
      return link.inliers;
    }
    const double span = least_ / kMinAgreementShare - least_;
    return link.inliers * std::clamp((link.agreement - least_) / span, -1.0, 1.0);
  }

 private:
  double least_;
};

// One way to place two parts to each other, with the links that agree with it.
struct Story {
  Pose2 first_from_second;  // of the parts' frames
  Eigen::Vector2d place_m;  // in the first part's frame, of the link that founded it
  std::vector<const Link*> links;
  double evidence = 0.0;
};

struct PartPair {
  int first = 0;
  int second = 0;
  auto operator<=>(const PartPair&) const = default;
};

class Joiner {
 public:
  Joiner(int frame_count, const std::vector<Link>& links, const std::vector<Link>& candidates)
      : candidates_(candidates), evidence_(candidates), part_(FindComponents(frame_count, links)) {
    part_from_base_ = ChainPoses(std::vector<Pose2>(static_cast<std::size_t>(frame_count)), links, {});
    for (int frame = 0; frame < frame_count; ++frame) {
      const auto part = static_cast<std::size_t>(part_[static_cast<std::size_t>(frame)]);
      members_.resize(std::max(members_.size(), part + 1));
      members_[part].push_back(frame);
    }
  }

  std::vector<Link> Run() {
    while (JoinOneRound()) {
    }
    return joining_;
  }

 private:
  bool JoinOneRound();
  std::map<PartPair, std::vector<Story>> CollectStories() const;
  void Tell(const PartPair& pair, const Link& link, std::vector<Story>* stories) const;
  const Story* Believable(const PartPair& pair, const std::vector<Story>& stories) const;
  void Join(const PartPair& pair, const Story& story);

  const Pose2& PoseOf(int frame) const { return part_from_base_[static_cast<std::size_t>(frame)]; }
  int PartOf(int frame) const { return part_[static_cast<std::size_t>(frame)]; }
  std::size_t SizeOf(int part) const { return members_[static_cast<std::size_t>(part)].size(); }

  const std::vector<Link>& candidates_;
  LinkEvidence evidence_;
  std::vector<int> part_;
  std::vector<Pose2> part_from_base_;
  std::vector<std::vector<int>> members_;
  std::vector<Link> joining_;
};

// link: from a frame of pair.first to one of pair.second, or the other way round.
void Joiner::Tell(const PartPair& pair, const Link& link, std::vector<Story>* stories) const {
  const bool forward = PartOf(link.first) == pair.first;
  const Pose2& first = PoseOf(forward ? link.first : link.second);
  const Pose2& second = PoseOf(forward ? link.second : link.first);
  const Pose2 motion = forward ? link.first_from_second : link.first_from_second.Inverse();
  const Pose2 seen = first * motion;
  const auto agrees = [&](const Story& story) {
    const Pose2 off = seen.Between(story.first_from_second * second);
    const double distance = (seen.translation() - story.place_m).norm();
    return off.translation().norm() < kSameM + kSameShare * distance && std::abs(off.yaw()) < kSameRad;
  };
  auto story = std::find_if(stories->begin(), stories->end(), agrees);
  if (story == stories->end()) {
    story = stories->insert(stories->end(), {seen * second.Inverse(), seen.translation(), {}, 0.0});
  }
  story->links.push_back(&link);
  story->evidence += evidence_.Of(link);
}

std::map<PartPair, std::vector<Story>> Joiner::CollectStories() const {
  std::map<PartPair, std::vector<Story>> stories;
  for (const Link& link : candidates_) {
    const auto [first, second] = std::minmax({PartOf(link.first), PartOf(link.second)});
    if (first != second) {
      Tell({first, second}, link, &stories[{first, second}]);
    }
  }
  return stories;
}

// The story to believe about two parts, or none.
const Story* Joiner::Believable(const PartPair& pair, const std::vector<Story>& stories) const {
  const auto best = std::max_element(stories.begin(), stories.end(),
                                     [](const Story& a, const Story& b) { return a.evidence < b.evidence; });
  for (auto s = stories.begin(); s != stories.end(); ++s) {
    if (s != best && kMinLead * s->evidence > best->evidence) {
      return nullptr;
    }
  }
  const bool small = std::min(SizeOf(pair.first), SizeOf(pair.second)) < kSmallPart;
  const bool enough = best->links.size() >= kMinLinks || (small && !evidence_.DoubtsSingleLinks());
  return enough && best->evidence > 0.0 ? &*best : nullptr;
}

// The smaller part moves into the frame of the larger one.
void Joiner::Join(const PartPair& pair, const Story& story) {
  const bool second_moves = SizeOf(pair.second) <= SizeOf(pair.first);
  const int moving = second_moves ? pair.second : pair.first;
  const int staying = second_moves ? pair.first : pair.second;
  const Pose2 motion = second_moves ? story.first_from_second : story.first_from_second.Inverse();
  std::vector<int>& frames = members_[static_cast<std::size_t>(moving)];
  for (const int frame : frames) {
    const auto index = static_cast<std::size_t>(frame);
    part_from_base_[index] = motion * part_from_base_[index];
    part_[index] = staying;
  }
  std::vector<int>& larger = members_[static_cast<std::size_t>(staying)];
  larger.insert(larger.end(), frames.begin(), frames.end());
  frames.clear();
  for (const Link* link : story.links) {
    joining_.push_back(*link);
  }
}

// Strongest first; a part that has grown in this round waits for the next, since its stories have changed.
bool Joiner::JoinOneRound() {
  const auto stories = CollectStories();
  std::vector<std::pair<PartPair, const Story*>> believable;
  for (const auto& [pair, list] : stories) {
    if (const Story* story = Believable(pair, list)) {
      believable.emplace_back(pair, story);
    }
  }
  std::stable_sort(believable.begin(), believable.end(),
                   [](const auto& a, const auto& b) { return a.second->evidence > b.second->evidence; });
  std::set<int> grown;
  for (const auto& [pair, story] : believable) {
    if (!grown.contains(pair.first) && !grown.contains(pair.second)) {
      Join(pair, *story);
      grown.insert({pair.first, pair.second});
    }
  }
  return !believable.empty();
}

}  // namespace

bool FloorRepeats(const std::vector<Link>& candidates) {
  const auto rivals =
      std::count_if(candidates.begin(), candidates.end(), [](const Link& link) { return link.rival_agreement > 0.0; });
  return static_cast<double>(rivals) > kRepeatingShare * static_cast<double>(candidates.size());
}

double MinAgreement(const std::vector<Link>& candidates) { return kMinAgreementShare * UsualAgreement(candidates); }

std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates) {
  return Joiner(frame_count, links, candidates).Run();
}

}  // namespace floorloc
