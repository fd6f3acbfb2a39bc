// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/join_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// Two links support the same hypothesis when their positions of a frame differ by less than kSameM plus kSameShare of
// the distance between the links, which allows for drift.
constexpr double kSameM = 0.05;
constexpr double kSameShare = 0.03;
constexpr double kSameRad = 0.06;

// The best hypothesis must have this many times the evidence of the second best.
constexpr double kMinLead = 1.5;

// Parts of at least this many frames need several links to be joined; on repetitive floors all parts do.
constexpr std::size_t kSmallPart = 3;
constexpr std::size_t kMinLinks = 2;

// Share of links with a rival above which the floor is repetitive.
constexpr double kRepeatingShare = 0.2;

// On repetitive floors, links need this share of the typical agreement of true links.
constexpr double kMinAgreementShare = 0.85;

// Typical agreement of true links: the median over frames of their best link's agreement.
double TypicalAgreement(const std::vector<Link>& candidates) {
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

// Evidence of a link. On floors without repetition, its inliers. On repetitive floors, aliased links agree nearly as
// well as true ones, so agreement clearly below typical counts against a join.
class LinkEvidence {
 public:
  explicit LinkEvidence(const std::vector<Link>& candidates)
      : min_agreement_(IsRepetitiveFloor(candidates) ? MinAgreement(candidates) : 0.0) {}

  bool RequiresSeveralLinks() const { return min_agreement_ > 0.0; }
  double Of(const Link& link) const {
    if (min_agreement_ <= 0.0) {
      return link.inliers;
    }
    const double span = min_agreement_ / kMinAgreementShare - min_agreement_;
    return link.inliers * std::clamp((link.agreement - min_agreement_) / span, -1.0, 1.0);
  }

 private:
  double min_agreement_;
};

// One hypothesis of the relative pose of two parts, with the links that support it.
struct PoseHypothesis {
  Pose2 first_from_second;     // of the parts' frames
  Eigen::Vector2d position_m;  // in the first part's frame, of the hypothesis's first link
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
  std::map<PartPair, std::vector<PoseHypothesis>> CollectHypotheses() const;
  void AddToHypothesis(const PartPair& pair, const Link& link, std::vector<PoseHypothesis>* hypotheses) const;
  const PoseHypothesis* AcceptedHypothesis(const PartPair& pair, const std::vector<PoseHypothesis>& hypotheses) const;
  void Join(const PartPair& pair, const PoseHypothesis& hypothesis);

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

// link: from a frame of pair.first to one of pair.second, or the reverse.
void Joiner::AddToHypothesis(const PartPair& pair, const Link& link, std::vector<PoseHypothesis>* hypotheses) const {
  const bool forward = PartOf(link.first) == pair.first;
  const Pose2& first = PoseOf(forward ? link.first : link.second);
  const Pose2& second = PoseOf(forward ? link.second : link.first);
  const Pose2 motion = forward ? link.first_from_second : link.first_from_second.Inverse();
  const Pose2 measured = first * motion;
  const auto agrees = [&](const PoseHypothesis& hypothesis) {
    const Pose2 off = measured.Between(hypothesis.first_from_second * second);
    const double distance = (measured.translation() - hypothesis.position_m).norm();
    return off.translation().norm() < kSameM + kSameShare * distance && std::abs(off.yaw()) < kSameRad;
  };
  auto hypothesis = std::find_if(hypotheses->begin(), hypotheses->end(), agrees);
  if (hypothesis == hypotheses->end()) {
    hypothesis = hypotheses->insert(hypotheses->end(), {measured * second.Inverse(), measured.translation(), {}, 0.0});
  }
  hypothesis->links.push_back(&link);
  hypothesis->evidence += evidence_.Of(link);
}

std::map<PartPair, std::vector<PoseHypothesis>> Joiner::CollectHypotheses() const {
  std::map<PartPair, std::vector<PoseHypothesis>> hypotheses;
  for (const Link& link : candidates_) {
    const auto [first, second] = std::minmax({PartOf(link.first), PartOf(link.second)});
    if (first != second) {
      AddToHypothesis({first, second}, link, &hypotheses[{first, second}]);
    }
  }
  return hypotheses;
}

// The accepted hypothesis for two parts, or nullptr.
const PoseHypothesis* Joiner::AcceptedHypothesis(const PartPair& pair,
                                                 const std::vector<PoseHypothesis>& hypotheses) const {
  const auto best =
      std::max_element(hypotheses.begin(), hypotheses.end(),
                       [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.evidence < b.evidence; });
  for (auto s = hypotheses.begin(); s != hypotheses.end(); ++s) {
    if (s != best && kMinLead * s->evidence > best->evidence) {
      return nullptr;
    }
  }
  const bool small = std::min(SizeOf(pair.first), SizeOf(pair.second)) < kSmallPart;
  const bool enough = best->links.size() >= kMinLinks || (small && !evidence_.RequiresSeveralLinks());
  return enough && best->evidence > 0.0 ? &*best : nullptr;
}

// Moves the smaller part into the frame of the larger one.
void Joiner::Join(const PartPair& pair, const PoseHypothesis& hypothesis) {
  const bool second_moves = SizeOf(pair.second) <= SizeOf(pair.first);
  const int moving = second_moves ? pair.second : pair.first;
  const int staying = second_moves ? pair.first : pair.second;
  const Pose2 motion = second_moves ? hypothesis.first_from_second : hypothesis.first_from_second.Inverse();
  std::vector<int>& frames = members_[static_cast<std::size_t>(moving)];
  for (const int frame : frames) {
    const auto index = static_cast<std::size_t>(frame);
    part_from_base_[index] = motion * part_from_base_[index];
    part_[index] = staying;
  }
  std::vector<int>& larger = members_[static_cast<std::size_t>(staying)];
  larger.insert(larger.end(), frames.begin(), frames.end());
  frames.clear();
  for (const Link* link : hypothesis.links) {
    joining_.push_back(*link);
  }
}

// Joins strongest first. A part that has grown in this round waits for the next one, since its hypotheses have changed.
bool Joiner::JoinOneRound() {
  const auto hypotheses = CollectHypotheses();
  std::vector<std::pair<PartPair, const PoseHypothesis*>> accepted;
  for (const auto& [pair, list] : hypotheses) {
    if (const PoseHypothesis* hypothesis = AcceptedHypothesis(pair, list)) {
      accepted.emplace_back(pair, hypothesis);
    }
  }
  std::stable_sort(accepted.begin(), accepted.end(),
                   [](const auto& a, const auto& b) { return a.second->evidence > b.second->evidence; });
  std::set<int> grown;
  for (const auto& [pair, hypothesis] : accepted) {
    if (!grown.contains(pair.first) && !grown.contains(pair.second)) {
      Join(pair, *hypothesis);
      grown.insert({pair.first, pair.second});
    }
  }
  return !accepted.empty();
}

}  // namespace

bool IsRepetitiveFloor(const std::vector<Link>& candidates) {
  const auto rivals =
      std::count_if(candidates.begin(), candidates.end(), [](const Link& link) { return link.rival_agreement > 0.0; });
  return static_cast<double>(rivals) > kRepeatingShare * static_cast<double>(candidates.size());
}

double MinAgreement(const std::vector<Link>& candidates) { return kMinAgreementShare * TypicalAgreement(candidates); }

std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates) {
  return Joiner(frame_count, links, candidates).Run();
}

}  // namespace floorloc
