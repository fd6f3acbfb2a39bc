// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/place_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "mapbuilder/placement/connected_parts.h"
#include "mapbuilder/placement/join_parts.h"
#include "mapbuilder/placement/robust_pose_graph.h"
#include "mapbuilder/placement/similar_pairs.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// Wheel odometry error per step, for a weak factor that matters only where vision gives no link.
constexpr double kOdometrySigmaM = 0.02;
constexpr double kOdometrySigmaShare = 0.1;
constexpr double kOdometrySigmaRad = 0.05;

// On repetitive floors, aliased places crowd out the true neighbours.
constexpr int kSimilarPairsPerFrame = 6;
constexpr int kSimilarPairsPerFrameIfRepeating = 20;

class Placer {
 public:
  Placer(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
         const PlacementOptions& options)
      : frames_(frames), surveys_(surveys), options_(options), count_(static_cast<int>(frames.size())) {
    floors_ = FloorsInBase(frames, surveys);
    graph_.map_from_base.assign(frames.size(), Pose2());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      graph_.map_from_base[i] = frames[i].odom_from_base.value_or(Pose2());
    }
    root_pose_ = graph_.map_from_base;
  }

  Placement Run() {
    MakeOdometryLinks();
    AddLinks(SelectConsecutivePairs(frames_));
    if (HasSeparateParts(graph_.LinksAndOdometry())) {
      JoinSeparateParts();
    }
    CloseLoopsInGrowingRounds();
    if (!graph_.odometry.empty() && HasSeparateParts(graph_.links)) {
      JoinDespiteOdometry();
    }
    control_points_ = AddAbsoluteConstraints(frames_, surveys_, options_.known_points, &graph_);
    RequireNearOrigin();
    return Finish();
  }

 private:
  void MakeOdometryLinks();
  void AddLinks(const std::vector<FramePair>& pairs);
  bool HasSeparateParts(const std::vector<Link>& trusted) const;
  void JoinSeparateParts();
  void JoinDespiteOdometry();
  void AddSimilarCandidates(const std::vector<Link>& trusted, int pairs_per_frame);
  bool AddJoiningLinks(const std::vector<Link>& trusted);
  void CloseLoopsInGrowingRounds();
  void CloseMissedLoops();
  void CloseLoops(int end, const NearbyOptions& options);
  void Optimize(int frame_count);
  std::vector<std::optional<Pose2>> PlacedUpTo(int frame_count) const;
  void RequireNearOrigin() const;
  Placement Finish();
  void CountUnmatchedOverlaps(Placement* placement) const;

  bool ByImagesAlone() const { return graph_.odometry.empty() && graph_.priors.empty(); }
  const Pose2& PoseOf(int frame) const { return graph_.map_from_base[static_cast<std::size_t>(frame)]; }

  const std::vector<BuildFrame>& frames_;
  const std::vector<LoadedSurvey>& surveys_;
  const PlacementOptions& options_;
  PairRegistrationOptions registration_ = options_.registration;
  double min_agreement_ = 0.0;  // of links, on repetitive floors only
  int count_;
  std::vector<RectM> floors_;
  std::vector<Pose2> root_pose_;
  PoseGraph graph_;
  std::vector<Link> candidates_;  // found by appearance, accepted only if others confirm them
  std::set<std::pair<int, int>> linked_;
  ControlPointFindings control_points_;
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
  std::vector<FramePair> fresh = pairs;
  std::erase_if(fresh, [&](const FramePair& pair) { return linked_.contains({pair.first, pair.second}); });
  for (Link& link : RegisterPairs(frames_, floors_, fresh, registration_)) {
    if (link.agreement >= min_agreement_) {
      linked_.emplace(link.first, link.second);
      graph_.links.push_back(std::move(link));
    }
  }
}

void Placer::AddSimilarCandidates(const std::vector<Link>& trusted, int pairs_per_frame) {
  std::set<std::pair<int, int>> known = linked_;
  for (const Link& link : candidates_) {
    known.emplace(link.first, link.second);
  }
  std::vector<FramePair> pairs =
      SelectSimilarPairs(frames_, FindComponents(count_, trusted), {pairs_per_frame, registration_.run});
  std::erase_if(pairs, [&](const FramePair& pair) { return known.contains({pair.first, pair.second}); });
  const std::vector<Link> similar = RegisterPairs(frames_, floors_, pairs, registration_);
  candidates_.insert(candidates_.end(), similar.begin(), similar.end());
}

bool Placer::HasSeparateParts(const std::vector<Link>& trusted) const {
  return std::ranges::any_of(FindComponents(count_, trusted), [](int c) { return c != 0; });
}

bool Placer::AddJoiningLinks(const std::vector<Link>& trusted) {
  const std::size_t before = graph_.links.size();
  for (const Link& link : FindJoiningLinks(count_, trusted, candidates_)) {
    if (linked_.emplace(link.first, link.second).second) {
      graph_.links.push_back(link);
    }
  }
  return graph_.links.size() > before;
}

// Joins, by appearance, parts that neither frame order nor odometry joins.
void Placer::JoinSeparateParts() {
  const std::vector<Link> trusted = graph_.LinksAndOdometry();
  AddSimilarCandidates(trusted, kSimilarPairsPerFrame);
  if (IsRepetitiveFloor(candidates_)) {
    AddSimilarCandidates(trusted, kSimilarPairsPerFrameIfRepeating);
    registration_.measure_agreement = true;
    min_agreement_ = MinAgreement(candidates_);
  }
  AddJoiningLinks(trusted);
}

// Where odometry put parts so wrongly that their overlaps were not found, appearance finds them. On floors that repeat
// themselves odometry is the better witness.
void Placer::JoinDespiteOdometry() {
  AddSimilarCandidates(graph_.links, kSimilarPairsPerFrame);
  if (!IsRepetitiveFloor(candidates_) && AddJoiningLinks(graph_.links)) {
    CloseLoops(count_, {});
    CloseMissedLoops();
  }
}

std::vector<std::optional<Pose2>> Placer::PlacedUpTo(int frame_count) const {
  // Parts that nothing joins lie on top of each other for now: only the largest may search for neighbours.
  const std::vector<int> component = FindComponents(count_, graph_.LinksAndOdometry());
  std::map<int, int> size;
  for (const int c : component) {
    ++size[c];
  }
  const auto largest = std::ranges::max_element(size, {}, [](const auto& part) { return part.second; });
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
  CloseMissedLoops();
}

void Placer::CloseMissedLoops() {
  // With the drift removed, poses are accurate to millimetres, so that missed overlaps are found now.
  Optimize(count_);
  NearbyOptions narrow;
  narrow.radius_m = 0.02;
  narrow.yaw_radius_rad = 0.05;
  AddLinks(SelectNearbyPairs(PlacedUpTo(count_), floors_, narrow));
  Optimize(count_);
}

// Links neighbouring frames, and repeats while optimisation brings further frames together.
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

void Placer::CountUnmatchedOverlaps(Placement* placement) const {
  NearbyOptions mostly;
  mostly.min_overlap = 0.5;
  for (const FramePair& pair : SelectNearbyPairs(placement->map_from_base, floors_, mostly)) {
    ++placement->overlapping_pairs;
    placement->unmatched_pairs += linked_.contains({pair.first, pair.second}) ? 0 : 1;
  }
  if (ByImagesAlone() && placement->unmatched_pairs > options_.max_unmatched_share * placement->overlapping_pairs) {
    throw InputError("the floor is too repetitive to find the frames' order from the images alone (" +
                     std::to_string(placement->unmatched_pairs) + " of " +
                     std::to_string(placement->overlapping_pairs) +
                     " pairs that should show the same floor do not match); survey with odometry.tum, or give --poses");
  }
}

void Placer::RequireNearOrigin() const {
  const auto farthest =
      std::ranges::max_element(graph_.map_from_base, {}, [](const Pose2& pose) { return pose.translation().norm(); });
  if (farthest->translation().norm() <= options_.max_distance_m) {
    return;
  }
  const char* const source = !graph_.control_points.empty() ? "control points and markers"
                             : !graph_.priors.empty()       ? "the file of --poses"
                                                            : "odometry.tum";
  const Eigen::Vector2d offset_m = 1000.0 * (farthest->translation() / 1000.0).array().round().matrix();
  char text[256];
  std::snprintf(text, sizeof(text),
                "the map would lie %.0f km from the origin of its coordinates (at most %.0f km): subtract (%.0f, %.0f) "
                "from the coordinates of %s, and add it to the poses that you get",
                1e-3 * farthest->translation().norm(), 1e-3 * options_.max_distance_m, offset_m.x(), offset_m.y(),
                source);
  throw InputError(text);
}

Placement Placer::Finish() {
  graph_.fixed = graph_.priors.empty() && graph_.control_points.empty() ? std::vector<int>{0} : std::vector<int>{};
  const RobustPoseGraphSummary summary = OptimizePosesRobustly(&graph_);
  Placement placement = PlaceConnectedParts(frames_, floors_, graph_, options_.keep_all);
  placement.rejected_links = summary.rejected_links;
  placement.control_points = control_points_;
  placement.repeats_unaided = min_agreement_ > 0.0 && ByImagesAlone() && graph_.control_points.empty();
  CountUnmatchedOverlaps(&placement);
  return placement;
}

}  // namespace

void PlacementOptions::Check() const {
  registration.Check();
  known_points.Check();
  RequireOption(prior_sigma_m > 0.0, "prior_sigma_m must be positive");
  RequireOption(prior_sigma_rad > 0.0, "prior_sigma_rad must be positive");
  RequireOption(max_distance_m > 0.0, "max_distance_m must be positive");
  RequireOption(max_unmatched_share >= 0.0 && max_unmatched_share <= 1.0, "max_unmatched_share must be 0 to 1");
}

Placement PlaceFrames(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                      const PlacementOptions& options) {
  options.Check();
  return Placer(frames, surveys, options).Run();
}

}  // namespace floorloc
