// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/merge/align_maps.h"

#include <algorithm>
#include <cmath>

#include "core/localization/oriented_matches.h"
#include "core/map/map_error.h"
#include "core/vision/matching/guided_matcher.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/finished_map/map_views.h"
#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {
namespace {

// Frames of the second map that are searched for in the whole first map.
constexpr std::size_t kProbes = 400;

// Minimum number of consistent fixes, and the tolerances, which allow for drift of the maps.
constexpr int kMinAgreeing = 3;
constexpr double kAgreeM = 0.05;
constexpr double kAgreeShare = 0.01;  // of the distance between two frames
constexpr double kAgreeRad = 0.05;

// Search radius around the predicted pose once the rigid motion is known.
constexpr double kRadiusM = 0.08;
constexpr double kRadiusRad = 0.06;

constexpr double kSystematicM = 2e-4;
constexpr double kSystematicRad = 4e-4;

class MapAligner {
 public:
  MapAligner(const BaseMap& first, const BaseMap& second, const MapAlignmentOptions& options)
      : first_(first),
        second_(second),
        options_(options),
        first_from_origin_(first.map.keypoints.MapFromOrigin()),
        views_(second),
        guided_(first.map.keypoints.keypoints, first.map.keypoints.descriptors, 40.0 * Resolution()) {
    registration_ = PairRegistrationOptions::DefaultRegistration();
    registration_.seed = options.seed;
    registration_ = registration_.ScaledTo(Resolution());
  }

  MapAlignment Run() {
    const Pose2 first_from_second = options_.same_frame ? Pose2() : FindMotion();
    PoseGraph graph;
    for (const MapFrame& frame : second_.frames) {
      graph.map_from_base.push_back(first_from_second * frame.map_from_base);
    }
    for (const MapLink& link : second_.links) {
      graph.links.push_back(
          {link.first, link.second, link.first_from_second, link.covariance, link.inliers, link.rms_m});
    }
    MapAlignment alignment;
    // Two rounds: after the first deformation, more frames are within the search radius.
    for (int round = 0; round < 2; ++round) {
      graph.priors = LocateNear(graph.map_from_base);
      if (graph.priors.size() >= kMinAgreeing) {
        OptimizePoses(&graph);
      }
    }
    alignment.shared_frames = static_cast<int>(graph.priors.size());
    if (alignment.shared_frames < kMinAgreeing && !options_.same_frame) {
      ThrowNotMergeable("too few of their frames show the same floor");
    }
    for (std::size_t i = 0; i < second_.frames.size(); ++i) {
      const Pose2 rigid = first_from_second * second_.frames[i].map_from_base;
      alignment.deformation_m =
          std::max(alignment.deformation_m, rigid.Between(graph.map_from_base[i]).translation().norm());
    }
    alignment.first_from_base = std::move(graph.map_from_base);
    return alignment;
  }

 private:
  double Resolution() const { return first_.map.info.camera().floor.resolution_m; }

  [[noreturn]] void ThrowNotMergeable(const std::string& why) const {
    throw MapError(second_.file.string() + " can't be merged with " + first_.file.string() + ": " + why +
                   "; survey the floor between them, or give --same-frame when both maps have one frame");
  }

  // Pose in the first map of a frame of the second, from the matches of its keypoints.
  std::optional<PosePriorFactor> Register(int frame, const Features& view, const std::vector<Match>& matches,
                                          double searched_m2) const {
    const std::vector<OrientedMatch> oriented =
        ToOrientedMatches(FilterByRatio(matches, MaxRatio()), view.keypoints, first_.map.keypoints.keypoints);
    const RegistrationResult result = RegisterSe2(oriented, {searched_m2}, registration_);
    if (!result.ok()) {
      return std::nullopt;
    }
    // Map errors rotate and shift a view as a whole, about its centre.
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const int i : result.inliers) {
      middle += oriented[static_cast<std::size_t>(i)].target_m / static_cast<double>(result.inliers.size());
    }
    const Eigen::Vector2d arm = result.target_from_source.translation() - middle;
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    jacobian(0, 2) = -arm.y();
    jacobian(1, 2) = arm.x();
    const Eigen::Vector3d variance(kSystematicM * kSystematicM, kSystematicM * kSystematicM,
                                   kSystematicRad * kSystematicRad);
    return PosePriorFactor{frame, first_from_origin_ * result.target_from_source,
                           result.covariance + jacobian * variance.asDiagonal() * jacobian.transpose()};
  }

  float MaxRatio() const {
    const PairRegistrationOptions pairs;
    return first_.map.keypoints.descriptors.depth() == CV_8U ? pairs.max_ratio_binary : pairs.max_ratio_float;
  }

  template <typename Locate>
  std::vector<PosePriorFactor> ForFrames(const std::vector<int>& frames, const char* label, const Locate& locate) {
    std::vector<std::optional<PosePriorFactor>> found(frames.size());
    ProgressBar progress(label, static_cast<std::int64_t>(frames.size()), options_.run.progress);
    ParallelFor(static_cast<int>(frames.size()), options_.run.threads, [&](int i) {
      found[static_cast<std::size_t>(i)] = locate(frames[static_cast<std::size_t>(i)]);
      progress.Advance();
    });
    std::vector<PosePriorFactor> fixes;
    for (const auto& fix : found) {
      if (fix) {
        fixes.push_back(*fix);
      }
    }
    return fixes;
  }

  // Global search in the first map; returns the rigid motion that most fixes agree on.
  Pose2 FindMotion() {
    IndexOptions index_options;
    index_options.seed = options_.seed;
    const auto index = CreateDescriptorIndex(first_.map.keypoints.descriptors, index_options);
    std::vector<int> probes;
    const std::size_t step = std::max<std::size_t>(1, second_.frames.size() / kProbes);
    for (std::size_t i = 0; i < second_.frames.size(); i += step) {
      probes.push_back(static_cast<int>(i));
    }
    const auto fixes = ForFrames(probes, "overlap", [&](int frame) -> std::optional<PosePriorFactor> {
      const Features view = views_.Of(second_.frames[static_cast<std::size_t>(frame)]);
      if (view.keypoints.empty()) {
        return std::nullopt;
      }
      return Register(frame, view, FindNearest(*index, view.descriptors), first_.map.info.area_m2);
    });
    Pose2 best;
    int max_agreeing = 0;
    for (const PosePriorFactor& fix : fixes) {
      const Pose2 motion = fix.map_from_base * PoseInSecond(fix.frame).Inverse();
      const auto agreeing =
          std::count_if(fixes.begin(), fixes.end(), [&](const auto& other) { return AgreesWith(motion, fix, other); });
      if (agreeing > max_agreeing) {
        max_agreeing = static_cast<int>(agreeing);
        best = motion;
      }
    }
    if (max_agreeing < kMinAgreeing) {
      ThrowNotMergeable("too few of their frames show the same floor");
    }
    if (2 * max_agreeing <= static_cast<int>(fixes.size())) {
      ThrowNotMergeable("the frames that show the same floor do not agree on one alignment of the maps");
    }
    return best;
  }

  const Pose2& PoseInSecond(int frame) const { return second_.frames[static_cast<std::size_t>(frame)].map_from_base; }

  bool AgreesWith(const Pose2& motion, const PosePriorFactor& fix, const PosePriorFactor& other) const {
    const Pose2 error = (motion * PoseInSecond(other.frame)).Between(other.map_from_base);
    const double way_m = (fix.map_from_base.translation() - other.map_from_base.translation()).norm();
    return error.translation().norm() < kAgreeM + kAgreeShare * way_m && std::abs(error.yaw()) < kAgreeRad;
  }

  // Localizes frames near their predicted poses.
  std::vector<PosePriorFactor> LocateNear(const std::vector<Pose2>& first_from_base) {
    std::vector<int> all;
    for (std::size_t i = 0; i < second_.frames.size(); ++i) {
      all.push_back(static_cast<int>(i));
    }
    return ForFrames(all, "fit", [&](int frame) -> std::optional<PosePriorFactor> {
      const Features view = views_.Of(second_.frames[static_cast<std::size_t>(frame)]);
      if (view.keypoints.empty()) {
        return std::nullopt;
      }
      const MatchGuide guide{first_from_origin_.Inverse() * first_from_base[static_cast<std::size_t>(frame)], kRadiusM,
                             kRadiusRad + kKeypointAngleNoiseRad};
      return Register(frame, view, guided_.FindNearest(view, guide), 3.14 * kRadiusM * kRadiusM);
    });
  }

  const BaseMap& first_;
  const BaseMap& second_;
  const MapAlignmentOptions& options_;
  Pose2 first_from_origin_;  // of the first map's keypoints
  MapViews views_;
  GuidedMatcher guided_;
  RegistrationOptions registration_;
};

}  // namespace

void MapAlignmentOptions::Check() const { run.Check(); }

MapAlignment AlignMaps(const BaseMap& first, const BaseMap& second, const MapAlignmentOptions& options) {
  options.Check();
  return MapAligner(first, second, options).Run();
}

}  // namespace floorloc
