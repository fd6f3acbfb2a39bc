// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/place_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/placement/join_parts.h"
#include "mapbuilder/placement/robust_pose_graph.h"
#include "mapbuilder/placement/similar_pairs.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// A wheel's error per step, for the weak factor that only matters where vision gives nothing.
constexpr double kOdometrySigmaM = 0.02;
constexpr double kOdometrySigmaShare = 0.1;
constexpr double kOdometrySigmaRad = 0.05;

// A part without a known place is put this far to the right of everything else.
constexpr double kPartGapM = 1.0;

// On repetitive floors, aliased places crowd out the true neighbours.
constexpr int kSimilarPairsPerFrame = 6;
constexpr int kSimilarPairsPerFrameIfRepeating = 20;

class Placer {
 public:
  Placer(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
         const PlacementOptions& options)
      : frames_(frames), surveys_(surveys), options_(options), count_(static_cast<int>(frames.size())) {
    for (const BuildFrame& frame : frames) {
      floors_.push_back(surveys[static_cast<std::size_t>(frame.survey)].survey.camera.floor.roi);
    }
    graph_.map_from_base.assign(frames.size(), Pose2());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      graph_.map_from_base[i] = frames[i].odom_from_base.value_or(Pose2());
    }
    root_pose_ = graph_.map_from_base;
  }

  Placement Run() {
    MakeOdometryLinks();
    AddLinks(SelectConsecutivePairs(frames_));
    if (HasSeparateParts()) {
      JoinSeparateParts();
    }
    CloseLoopsInGrowingRounds();
    AddAbsoluteConstraints();
    return Finish();
  }

 private:
  void MakeOdometryLinks();
  void AddLinks(const std::vector<FramePair>& pairs);
  std::vector<Link> LinksAndOdometry() const;
  bool HasSeparateParts() const;
  void JoinSeparateParts();
  void AddSimilarCandidates(int pairs_per_frame);
  void CloseLoopsInGrowingRounds();
  void CloseLoops(int end, const NearbyOptions& options);
  void Optimize(int frame_count);
  std::vector<std::optional<Pose2>> PlacedUpTo(int frame_count) const;
  void AddAbsoluteConstraints();
  // A frame's point whose place in the map is known.
  struct KnownPoint {
    int frame = 0;
    OrientedMatch pair;
  };
  void AlignTo(const std::vector<KnownPoint>& known_points);
  std::set<int> PartsToKeep(const std::vector<int>& part, int largest) const;
  void SeparateParts(const std::vector<int>& part, int largest);
  Placement Finish();
  void CountUnmatchedOverlaps(Placement* placement) const;
  void ReportDrift(Placement* placement) const;

  const Pose2& PoseOf(int frame) const { return graph_.map_from_base[static_cast<std::size_t>(frame)]; }

  const std::vector<BuildFrame>& frames_;
  const std::vector<LoadedSurvey>& surveys_;
  const PlacementOptions& options_;
  PairRegistrationOptions registration_ = options_.registration;
  double min_agreement_ = 0.0;  // of links, on repetitive floors
  int count_;
  std::vector<RectM> floors_;
  std::vector<Pose2> root_pose_;
  PoseGraph graph_;
  std::vector<Link> candidates_;  // found by appearance, to be accepted when others confirm them
  std::set<std::pair<int, int>> linked_;
};

void Placer::MakeOdometryLinks() {
  for (const FramePair& pair : SelectConsecutivePairs(frames_)) {
    if (!pair.first_from_second) {
      continue;
    }
    const double sigma = kOdometrySigmaM + kOdometrySigmaShare * pair.first_from_second->translation().norm();
    const Eigen::Vector3d variance(sigma * sigma, sigma * sigma, kOdometrySigmaRad * kOdometrySigmaRad);
    graph_.odometry.push_back({pair.first, pair.second, *pair.first_from_second, variance.asDiagonal(), 0, 0.0});
  }
}

void Placer::AddLinks(const std::vector<FramePair>& pairs) {
  std::vector<FramePair> fresh;
  for (const FramePair& pair : pairs) {
    if (!linked_.contains({pair.first, pair.second})) {
      fresh.push_back(pair);
    }
  }
  for (Link& link : RegisterPairs(frames_, floors_, fresh, registration_)) {
    if (link.agreement >= min_agreement_) {
      linked_.emplace(link.first, link.second);
      graph_.links.push_back(std::move(link));
    }
  }
}

std::vector<Link> Placer::LinksAndOdometry() const {
  std::vector<Link> all = graph_.links;
  all.insert(all.end(), graph_.odometry.begin(), graph_.odometry.end());
  return all;
}

void Placer::AddSimilarCandidates(int pairs_per_frame) {
  std::set<std::pair<int, int>> known = linked_;
  for (const Link& link : candidates_) {
    known.emplace(link.first, link.second);
  }
  std::vector<FramePair> pairs =
      SelectSimilarPairs(frames_, FindComponents(count_, LinksAndOdometry()), {pairs_per_frame, registration_.threads});
  std::erase_if(pairs, [&](const FramePair& pair) { return known.contains({pair.first, pair.second}); });
  const std::vector<Link> similar = RegisterPairs(frames_, floors_, pairs, registration_);
  candidates_.insert(candidates_.end(), similar.begin(), similar.end());
}

bool Placer::HasSeparateParts() const {
  const std::vector<int> component = FindComponents(count_, LinksAndOdometry());
  return std::any_of(component.begin(), component.end(), [](int c) { return c != 0; });
}

// Parts that neither order nor odometry joins: only appearance can join them.
void Placer::JoinSeparateParts() {
  AddSimilarCandidates(kSimilarPairsPerFrame);
  if (IsRepetitiveFloor(candidates_)) {
    AddSimilarCandidates(kSimilarPairsPerFrameIfRepeating);
    registration_.measure_agreement = true;
    min_agreement_ = MinAgreement(candidates_);
  }
  for (const Link& link : FindJoiningLinks(count_, LinksAndOdometry(), candidates_)) {
    if (linked_.emplace(link.first, link.second).second) {
      graph_.links.push_back(link);
    }
  }
}

std::vector<std::optional<Pose2>> Placer::PlacedUpTo(int frame_count) const {
  // Parts that nothing joins lie on top of each other for now: only the largest may search for neighbours.
  const std::vector<int> component = FindComponents(count_, LinksAndOdometry());
  std::map<int, int> size;
  for (const int c : component) {
    ++size[c];
  }
  const auto largest =
      std::max_element(size.begin(), size.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<std::optional<Pose2>> placed(frames_.size());
  for (int i = 0; i < frame_count; ++i) {
    const auto index = static_cast<std::size_t>(i);
    if (component[index] == largest->first) {
      placed[index] = graph_.map_from_base[index];
    }
  }
  return placed;
}

void Placer::Optimize(int frame_count) {
  PoseGraph part;
  const auto inside = [&](const Link& link) { return link.first < frame_count && link.second < frame_count; };
  std::copy_if(graph_.links.begin(), graph_.links.end(), std::back_inserter(part.links), inside);
  std::copy_if(graph_.odometry.begin(), graph_.odometry.end(), std::back_inserter(part.odometry), inside);
  part.map_from_base = ChainPoses(root_pose_, part.links, part.odometry);
  part.fixed = {0};
  OptimizePoses(&part);
  graph_.map_from_base = std::move(part.map_from_base);
}

void Placer::CloseLoopsInGrowingRounds() {
  constexpr int kFirstRound = 150;
  constexpr int kGrowth = 4;
  NearbyOptions wide;
  int done = 0;
  while (done < count_) {
    const int end = std::min(count_, std::max(kFirstRound, done + done / kGrowth));
    wide.first_new = done;
    CloseLoops(end, wide);
    done = end;
  }
  // With the drift removed, the places are known to millimetres: overlaps that were missed are found now.
  Optimize(count_);
  NearbyOptions narrow;
  narrow.radius_m = 0.02;
  narrow.yaw_radius_rad = 0.05;
  AddLinks(SelectNearbyPairs(PlacedUpTo(count_), floors_, narrow));
  Optimize(count_);
}

// Links neighbours, and again as long as that moves frames to new neighbours.
void Placer::CloseLoops(int end, const NearbyOptions& options) {
  constexpr int kMaxPasses = 4;
  Optimize(end);
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::vector<Pose2> before = graph_.map_from_base;
    AddLinks(SelectNearbyPairs(PlacedUpTo(end), floors_, options));
    Optimize(end);
    double moved_m = 0.0;
    for (int i = options.first_new; i < end; ++i) {
      const auto index = static_cast<std::size_t>(i);
      moved_m = std::max(moved_m, (before[index].translation() - PoseOf(i).translation()).norm());
    }
    if (moved_m < 0.5 * options.radius_m) {
      return;
    }
  }
}

// Moves each part of the graph so that its own pairs (source: where it is, target: where it should be) agree. What
// knows nothing of its place goes with the first part that does.
void Placer::AlignTo(const std::vector<KnownPoint>& known_points) {
  const std::vector<int> part = FindComponents(count_, LinksAndOdometry());
  std::map<int, std::vector<OrientedMatch>> pairs;
  for (const KnownPoint& known_point : known_points) {
    pairs[part[static_cast<std::size_t>(known_point.frame)]].push_back(known_point.pair);
  }
  std::map<int, Pose2> motion;
  for (const auto& [number, pairs_of_part] : pairs) {
    std::vector<int> all(pairs_of_part.size());
    std::iota(all.begin(), all.end(), 0);
    const auto fit = pairs_of_part.size() > 1 ? FitRigid(pairs_of_part, all) : std::nullopt;
    if (fit) {
      motion.emplace(number, *fit);
    }
  }
  for (std::size_t i = 0; i < frames_.size() && !motion.empty(); ++i) {
    const auto own = motion.find(part[i]);
    graph_.map_from_base[i] = (own != motion.end() ? own : motion.begin())->second * graph_.map_from_base[i];
  }
}

void Placer::AddAbsoluteConstraints() {
  std::vector<KnownPoint> known_points;
  std::map<std::pair<int, std::string>, int> by_name;
  for (int i = 0; i < count_; ++i) {
    const BuildFrame& frame = frames_[static_cast<std::size_t>(i)];
    by_name[{frame.survey, frame.info.filename}] = i;
    if (frame.prior) {
      graph_.priors.push_back({i, frame.prior->map_from_base, frame.prior->covariance});
      known_points.push_back({i, {PoseOf(i).translation(), frame.prior->map_from_base.translation(), 0.0, 0.0}});
    }
  }
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    for (const ControlPoint& point : surveys_[s].survey.control_points) {
      ControlPointFactor factor;
      factor.frame = by_name.at({static_cast<int>(s), point.filename});
      factor.point_in_base_m = surveys_[s].survey.camera.FloorFromRawPixel(point.raw_px);
      factor.point_in_map_m = point.point_in_map_m;
      graph_.control_points.push_back(factor);
      known_points.push_back(
          {factor.frame, {PoseOf(factor.frame) * factor.point_in_base_m, factor.point_in_map_m, 0.0, 0.0}});
    }
  }
  if (known_points.size() == 1) {
    throw InputError("one control point or pose does not fix the map's position and heading; give at least two");
  }
  AlignTo(known_points);
}

// Those whose place in the map is known, by two poses or control points; the largest when none is.
std::set<int> Placer::PartsToKeep(const std::vector<int>& part, int largest) const {
  std::map<int, int> known;
  for (const PosePriorFactor& prior : graph_.priors) {
    ++known[part[static_cast<std::size_t>(prior.frame)]];
  }
  for (const ControlPointFactor& point : graph_.control_points) {
    ++known[part[static_cast<std::size_t>(point.frame)]];
  }
  std::set<int> keep;
  for (const auto& [number, count] : known) {
    if (count > 1) {
      keep.insert(number);
    }
  }
  return keep.empty() ? std::set<int>{largest} : keep;
}

// Parts whose relation to the largest is unknown go beside it.
void Placer::SeparateParts(const std::vector<int>& part, int largest) {
  if (!graph_.odometry.empty()) {
    return;  // odometry says where they are
  }
  std::map<int, Eigen::AlignedBox2d> boxes;
  for (int i = 0; i < count_; ++i) {
    const auto index = static_cast<std::size_t>(i);
    boxes[part[index]].extend(PoseOf(i) * floors_[index].Center());
  }
  double right = boxes[largest].max().x();
  std::map<int, Eigen::Vector2d> shift{{largest, Eigen::Vector2d::Zero()}};
  for (const auto& [number, box] : boxes) {
    if (number != largest) {
      shift[number] = Eigen::Vector2d(right + kPartGapM - box.min().x(), boxes[largest].min().y() - box.min().y());
      right += kPartGapM + box.sizes().x();
    }
  }
  for (int i = 0; i < count_; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const Eigen::Vector2d& t = shift[part[index]];
    graph_.map_from_base[index] = Pose2(t.x(), t.y(), 0.0) * graph_.map_from_base[index];
  }
}

void Placer::CountUnmatchedOverlaps(Placement* placement) const {
  NearbyOptions mostly;
  mostly.min_overlap = 0.5;
  for (const FramePair& pair : SelectNearbyPairs(placement->map_from_base, floors_, mostly)) {
    ++placement->overlapping_pairs;
    placement->unmatched_pairs += linked_.contains({pair.first, pair.second}) ? 0 : 1;
  }
  if (graph_.odometry.empty() && graph_.priors.empty() &&
      placement->unmatched_pairs > options_.max_unmatched_share * placement->overlapping_pairs) {
    throw InputError("the floor is too repetitive to find the frames' order from the images alone (" +
                     std::to_string(placement->unmatched_pairs) + " of " +
                     std::to_string(placement->overlapping_pairs) +
                     " pairs that should show the same floor do not match); survey with odometry.tum, or give --poses");
  }
}

void Placer::ReportDrift(Placement* placement) const {
  // Odometry's frame is the one that fits its first pose: what remains afterwards is drift.
  std::map<int, Pose2> map_from_odom;
  for (int i = 0; i < count_; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const BuildFrame& frame = frames_[index];
    if (!placement->map_from_base[index] || !frame.odom_from_base) {
      continue;
    }
    const Pose2& pose = *placement->map_from_base[index];
    const auto anchor = map_from_odom.try_emplace(frame.survey, pose * frame.odom_from_base->Inverse()).first;
    const Pose2 error = pose.Between(anchor->second * *frame.odom_from_base);
    placement->drift_m = std::max(placement->drift_m, error.translation().norm());
    placement->drift_rad = std::max(placement->drift_rad, std::abs(error.yaw()));
  }
}

Placement Placer::Finish() {
  graph_.fixed = graph_.priors.empty() && graph_.control_points.empty() ? std::vector<int>{0} : std::vector<int>{};
  const RobustPoseGraphSummary summary = OptimizePosesRobustly(&graph_);

  const std::vector<int> part = FindComponents(count_, graph_.links);
  std::map<int, int> size;
  for (const int p : part) {
    ++size[p];
  }
  const auto largest =
      std::max_element(size.begin(), size.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (count_ > 1 && largest->second == 1) {
    throw InputError(
        "no two frames of the survey show the same floor; survey with at least a third of each image "
        "overlapping the next, and check camera.yaml and floor.yaml");
  }
  if (options_.keep_all) {
    SeparateParts(part, largest->first);
  }
  Placement placement;
  placement.map_from_base.resize(frames_.size());
  placement.drop_reason.resize(frames_.size());
  const std::set<int> keep = PartsToKeep(part, largest->first);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const bool alone = size[part[i]] == 1 && count_ > 1;
    if (keep.contains(part[i]) || (options_.keep_all && !alone)) {
      placement.map_from_base[i] = graph_.map_from_base[i];
    } else if (frames_[i].features.keypoints.empty()) {
      placement.drop_reason[i] = "no texture";
    } else {
      placement.drop_reason[i] = alone                           ? "matches no other frame"
                                 : keep.contains(largest->first) ? "not connected to the largest part"
                                                                 : "not connected to a part of known pose";
    }
  }
  for (const auto& [number, frames_of_part] : size) {
    if (frames_of_part > 1) {
      placement.part_sizes.push_back(frames_of_part);
    }
  }
  std::sort(placement.part_sizes.rbegin(), placement.part_sizes.rend());
  const LinkStatistics statistics =
      MeasureLinks(graph_.links, {graph_.map_from_base.begin(), graph_.map_from_base.end()});
  placement.rms_m = statistics.rms_m;
  placement.rms_sigma = statistics.rms_sigma;
  placement.links = graph_.links;
  placement.rejected_links = summary.rejected_links;
  CountUnmatchedOverlaps(&placement);
  ReportDrift(&placement);
  return placement;
}

}  // namespace

void PlacementOptions::Check() const {
  if (!(prior_sigma_m > 0.0 && prior_sigma_rad > 0.0)) {
    throw std::invalid_argument("prior_sigma_m and prior_sigma_rad must be positive");
  }
  if (!(max_unmatched_share >= 0.0 && max_unmatched_share <= 1.0)) {
    throw std::invalid_argument("max_unmatched_share must be 0 to 1");
  }
}

Placement PlaceFrames(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                      const PlacementOptions& options) {
  options.Check();
  return Placer(frames, surveys, options).Run();
}

}  // namespace floorloc
