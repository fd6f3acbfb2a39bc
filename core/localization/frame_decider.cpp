// SPDX-License-Identifier: Apache-2.0
#include "core/localization/frame_decider.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/localization/frame_report.h"
#include "core/localization/pose_decision.h"
#include "core/photometry/photometric_aligner.h"

namespace floorloc {
namespace {

std::vector<int> CellsOf(const FrameObservation& frame) {
  std::vector<int> cells;
  cells.reserve(frame.features.keypoints.size());
  for (const Keypoint& k : frame.features.keypoints) {
    cells.push_back(frame.samples.CellAt(k.Position()));
  }
  return cells;
}

}  // namespace

// The best pose is aligned to the mosaic; so are its rivals when the keypoints alone do not decide or the view does
// not agree. On a lattice its other places are compared then.
PoseDecision FrameDecider::Decide(const FrameObservation& frame, const SearchScope& scope, GlobalSearchCache* global,
                                  std::vector<VerifiedPose>* poses) const {
  if (scope.modulo) {
    return DecideModulo(frame, scope, global, poses);
  }
  const bool unquestioned = scope.IsUnquestioned(options_.search);
  PoseEvidence evidence{sources_.search.max_distance(), CellsOf(frame),
                        sources_.search.floor_repeats() && !unquestioned};
  PoseDecision decision = DecidePose(*poses, evidence, options_.registration, options_.decision);
  if (sources_.raster == nullptr || decision.best < 0 || !IsComparable(frame.samples)) {
    return decision;
  }
  if (decision.p_wrong <= options_.decision.clear_p_wrong) {
    VerifiedPose& best = (*poses)[static_cast<std::size_t>(decision.best)];
    Align(frame.samples, &best);
    const double p_local = best.view ? best.view->LocalProbability() : 0.0;
    if (p_local <= options_.decision.clear_p_wrong) {
      decision.p_wrong = std::max(decision.p_wrong, p_local);
      return decision;
    }
  }
  AlignAll(frame.samples, poses);
  decision = DecidePose(*poses, evidence, options_.registration, options_.decision);
  if (sources_.lattice == nullptr || unquestioned || decision.best < 0 ||
      decision.p_wrong <= options_.decision.clear_p_wrong) {
    return decision;
  }
  const LatticeComparison* places =
      ComparePlaces(frame, scope, (*poses)[static_cast<std::size_t>(decision.best)], &global->places);
  if (places == nullptr) {
    return decision;
  }
  AddLikelyPlaces(frame, *places, poses);
  evidence.lattice = places;
  return DecidePose(*poses, evidence, options_.registration, options_.decision);
}

// Keypoints tell the pose modulo the lattice, the comparison of its places the place. Poses at no place are dropped.
PoseDecision FrameDecider::DecideModulo(const FrameObservation& frame, const SearchScope& scope,
                                        GlobalSearchCache* global, std::vector<VerifiedPose>* poses) const {
  if (!IsComparable(frame.samples)) {
    return {};
  }
  std::stable_sort(poses->begin(), poses->end(), [](const VerifiedPose& a, const VerifiedPose& b) {
    return a.candidate.log10_nfa < b.candidate.log10_nfa;
  });
  for (VerifiedPose& pose : *poses) {
    Align(frame.samples, &pose);
    if (const LatticeComparison* places = ComparePlaces(frame, scope, pose, &global->places)) {
      std::erase_if(*poses, [&](const VerifiedPose& other) {
        return places->Find(other.candidate.target_from_source) == nullptr;
      });
      AlignAll(frame.samples, poses);
      AddLikelyPlaces(frame, *places, poses);
      PoseEvidence evidence{sources_.search.max_distance(), CellsOf(frame), true};
      evidence.lattice = places;
      return DecidePose(*poses, evidence, options_.registration, options_.decision);
    }
  }
  return {};
}

// Fine structure is lost in a mosaic much coarser than the frame: it agrees by chance, and the keypoints, which are
// from survey frames, tell the pose better.
bool FrameDecider::IsComparable(const FrameSamples& samples) const {
  return sources_.raster->resolution_m() <= options_.decision.max_mosaic_coarseness * samples.resolution_m();
}

// At every place of the lattice where the frame may be if it is at this pose or at another place like it; nullptr:
// too few can be compared. compared: of an earlier scope, used again where it has the pose.
const LatticeComparison* FrameDecider::ComparePlaces(const FrameObservation& frame, const SearchScope& scope,
                                                     const VerifiedPose& pose,
                                                     std::optional<LatticeComparison>* compared) const {
  if (!Agrees(*pose.photo, options_)) {
    return nullptr;
  }
  const Pose2 map_from_origin = sources_.map.keypoints.MapFromOrigin();
  if (!*compared || (*compared)->Find(pose.photo->map_from_base) == nullptr) {
    PhotometricFit fit = *pose.photo;
    fit.map_from_base = map_from_origin * fit.map_from_base;
    *compared = sources_.lattice->Compare(frame.samples, fit, PlacesToCompare(scope));
    if (!*compared) {
      return nullptr;
    }
    for (LatticePlace& place : (*compared)->places) {
      place.map_from_base = map_from_origin.Inverse() * place.map_from_base;
    }
  }
  for (LatticePlace& place : (*compared)->places) {
    place.prior_weight = scope.Contains(place.map_from_base) ? 1.0 : scope.WeightOutside(options_.search);
  }
  (*compared)->prior_weight_elsewhere = scope.WeightOutside(options_.search);
  return &**compared;
}

int FrameDecider::PlacesToCompare(const SearchScope& scope) const {
  const LatticeComparisonOptions& o = options_.lattice_comparison;
  const bool near = scope.prior && scope.prior->p_elsewhere.value_or(1.0) <= options_.search.prior_failure_rate;
  return near ? o.near_places : o.max_places;
}

// Makes the likely places that the search did not find poses.
void FrameDecider::AddLikelyPlaces(const FrameObservation& frame, const LatticeComparison& compared,
                                   std::vector<VerifiedPose>* poses) const {
  const double least = compared.places.front().log_likelihood + std::log(options_.registration.max_p_wrong);
  for (const LatticePlace& place : compared.places) {
    const bool known = std::any_of(poses->begin(), poses->end(), [&](const VerifiedPose& pose) {
      return compared.Find(pose.candidate.target_from_source) == &place;
    });
    if (known || place.log_likelihood < least) {
      continue;
    }
    if (static_cast<int>(poses->size()) >= options_.lattice_comparison.max_poses) {
      return;
    }
    VerifiedPose pose = sources_.search.Verify(frame, place.map_from_base);
    Align(frame.samples, &pose);
    pose.outside_prior = place.prior_weight < 1.0;
    pose.prior_weight = place.prior_weight;
    poses->push_back(std::move(pose));
  }
}

void FrameDecider::Align(const FrameSamples& samples, VerifiedPose* pose) const {
  const Pose2 map_from_origin = sources_.map.keypoints.MapFromOrigin();
  const bool rough = static_cast<int>(pose->candidate.inliers.size()) < options_.photometric.sure_inliers;
  pose->photo = PhotometricAligner(*sources_.raster, options_.photometric)
                    .Align(samples, map_from_origin * pose->candidate.target_from_source, rough);
  pose->photo->map_from_base = map_from_origin.Inverse() * pose->photo->map_from_base;
  std::vector<float> cells = pose->photo->ComparedCells();
  if (!cells.empty()) {
    pose->view = MeasureViewSupport(std::move(cells), {options_.decision.cell_sigma, options_.decision.local_share});
  }
}

void FrameDecider::AlignAll(const FrameSamples& samples, std::vector<VerifiedPose>* poses) const {
  std::for_each(poses->begin(), poses->end(), [&](VerifiedPose& pose) {
    if (!pose.photo) {
      Align(samples, &pose);
    }
  });
}

}  // namespace floorloc
