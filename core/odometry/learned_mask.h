// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/odometry/view_cells.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// When a vehicle leaves out of its images what travels with its camera. Deciding numbers: docs/server.md has the
/// measurements.
struct LearnedMaskOptions {
  bool apply = true;  ///< false: what is learnt is only reported
  ViewCellOptions cells;
  /// Mean motion of the view's corners between two compared views, as a share of its shorter side.
  double min_motion = 0.1;
  double max_motion = 0.7;
  int min_background = 8;      ///< views of which the background is the mean, before any is compared
  int min_pairs = 12;          ///< views that must show a cell
  double memory_pairs = 30.0;  ///< evidence fades by this number of pairs: a part that is gone is unlearnt
  double min_standing = 0.7;   ///< share of the views in which what is masked stands still
  double min_beside = 0.35;    ///< the same for cells beside such ones: the edge of a part
  double max_floor = 0.2;      ///< share of the views in which the floor shows through
  int min_region_cells = 3;    ///< smaller regions are left
  double max_share = 0.4;      ///< of the floor in view; when more stands still nothing is masked
  /// Views that are not looked at after one that showed nothing new, once memory_pairs are known: it saves time, and a
  /// part that is mounted later is seen by the next one. 0: every view is looked at.
  int rest_views = 8;
  double news_share = 0.03;  ///< of the cells in view that are masked and moved, or not and stood still: something new

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

enum class LearnedMaskStatus {
  kLearning,  ///< too few views that show the floor moving
  kNothing,   ///< nothing stands still
  kLearnt,    ///< something is masked
  kTooMuch,   ///< more than max_share stands still; nothing is masked
};
/// "learning", "nothing", "learnt", "too_much"
const char* ToString(LearnedMaskStatus status);

/// What a vehicle has learnt of its camera's view.
struct LearnedMaskState {
  LearnedMaskStatus status = LearnedMaskStatus::kLearning;
  int pairs = 0;       ///< of views that showed the floor moving
  double share = 0.0;  ///< of the floor in view that stands still, 0..1
  /// CV_8UC1 of any size, stretched over the region of interest; not 0 where it is no floor. Never written to again:
  /// it may be kept without a lock. Empty: nothing.
  cv::Mat left_out;

  /// Share of the floor in view that is left out.
  double LeftOutShare() const { return left_out.empty() ? 0.0 : share; }
};

/// What views told of a camera: enough to go on learning elsewhere.
struct MaskEvidence {
  cv::Size cells;      ///< across and down the view; empty: there was none
  GroundGrid grid;     ///< of the newest view
  CellVotes votes;     ///< sums; empty: no pair was compared
  int pairs = 0;       ///< LearnedMaskState::pairs
  double share = 0.0;  ///< LearnedMaskState::share
};

/// Learns what stands still in the images of a vehicle's camera while the floor moves. A cell of the image is masked
/// when most of the views that showed the floor moving showed structure in it that stood still, and through which the
/// floor was not seen. Cells without structure prove nothing and are not masked. Not thread-safe.
class LearnedMask {
 public:
  /// Throws std::invalid_argument on bad options.
  explicit LearnedMask(const LearnedMaskOptions& options = {});

  /// Compares a view with the reference. image: without anything learnt left out. reference_from_view: the base's
  /// motion as different sources tell it, the best first; empty: unknown. True when this view becomes the reference.
  bool Add(const GroundImage& image, const std::vector<Pose2>& reference_from_view);
  const LearnedMaskState& State() const { return state_; }
  /// Shares no memory with this one.
  MaskEvidence Learnt() const;
  /// Goes on with what another one learnt of this camera. Views are compared again after min_background of them.
  void Resume(const MaskEvidence& evidence);

 private:
  void Use(const SmallView& view);
  void AddVotes(const CellVotes& votes);
  void Measure(const SmallView& view);
  void Decide();
  bool ShowsNews(const CellVotes& votes) const;
  cv::Mat Proven() const;

  LearnedMaskOptions options_;
  ViewCells cells_;
  std::optional<SmallView> reference_;
  cv::Mat background_;  // CV_32FC1, mean contrast
  int background_views_ = 0;
  int resting_views_ = 0;  // still to be left out
  MaskEvidence evidence_;
  LearnedMaskState state_;  // that follows from it
};

}  // namespace floorloc
