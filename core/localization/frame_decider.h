// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/lattice/lattice_comparison.h"
#include "core/localization/candidate_search.h"
#include "core/localization/frame_observation.h"
#include "core/localization/localizer_options.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/search_scope.h"
#include "core/map/mosaic_raster.h"
#include "core/registration/pose_choice.h"

namespace floorloc {

/// What a map offers for a decision; all of it must outlive the FrameDecider.
struct DecisionSources {
  const FloorMap& map;
  const CandidateSearch& search;
  const MosaicRaster* raster = nullptr;      ///< nullptr: keypoints alone decide
  const LatticeComparer* lattice = nullptr;  ///< of a floor that repeats itself
};

/// Decides among the poses of a frame: by its keypoints, where these do not suffice by its pixels, on a floor that
/// repeats itself by comparing all places where it may be. Const and thread-safe.
class FrameDecider {
 public:
  /// options: scaled to the map's resolution; must outlive it.
  FrameDecider(const DecisionSources& sources, const LocalizerOptions& options)
      : sources_(sources), options_(options) {}

  /// poses: of the search, relative to the keypoints' origin; other places of the lattice are added, poses are aligned.
  PoseDecision Decide(const FrameObservation& frame, const SearchScope& scope, GlobalSearchCache* global,
                      std::vector<VerifiedPose>* poses) const;

 private:
  PoseDecision DecideModulo(const FrameObservation& frame, const SearchScope& scope, GlobalSearchCache* global,
                            std::vector<VerifiedPose>* poses) const;
  void Align(const FrameSamples& samples, VerifiedPose* pose) const;
  void AlignAll(const FrameSamples& samples, std::vector<VerifiedPose>* poses) const;
  bool IsComparable(const FrameSamples& samples) const;
  const LatticeComparison* ComparePlaces(const FrameObservation& frame, const SearchScope& scope,
                                         const VerifiedPose& pose, std::optional<LatticeComparison>* compared) const;
  int PlacesToCompare(const SearchScope& scope) const;
  void AddLikelyPlaces(const FrameObservation& frame, const LatticeComparison& compared,
                       std::vector<VerifiedPose>* poses) const;

  DecisionSources sources_;
  const LocalizerOptions& options_;
};

}  // namespace floorloc
