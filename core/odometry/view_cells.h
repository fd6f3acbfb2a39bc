// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/geometry/pose2.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// How two views of a camera are compared, cell by cell: the numbers of the builder's FixedStructureOptions, which
/// compares many pairs of images after the fact. docs/server.md has the measurements.
struct ViewCellOptions {
  int cells = 32;       ///< along the longer side of the region of interest
  double noise = 0.01;  ///< contrast below this is noise, as a share of the brightness
  /// A pair counts when the floor's motion explains this share of the cells that one of the hypotheses explains.
  double min_moving_share = 0.2;
  double min_decided_share = 0.1;  ///< of the cells in view of both that are seen moving in such a pair
  double min_correlation = 0.5;    ///< of structure that is recognised
  double min_lead = 0.25;          ///< by which standing still must explain it better than the floor's motion

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The floor in view at a small size, relative to its light, which neither exposure nor vignetting changes.
struct SmallView {
  cv::Mat contrast;  ///< CV_32FC1, kCellPx pixels a cell; 0 where nothing is seen
  cv::Mat seen;      ///< CV_8UC1 of that size, 255 where the camera sees the floor
  GroundGrid grid;   ///< of the image that it was made from
};

/// Cells across and down an image of a SmallView.
cv::Size CellsOf(const cv::Mat& small);

/// What a pair of views tells of each cell of the image. CV_32FC1, numbers of views: 0 to 2.
struct CellVotes {
  cv::Mat views;     ///< that showed the cell's floor in the other one
  cv::Mat standing;  ///< in which it stood still in the image
  cv::Mat floor;     ///< in which the floor was seen moving
};

/// Compares views of one camera. Immutable.
class ViewCells {
 public:
  explicit ViewCells(const ViewCellOptions& options) : options_(options) {}

  SmallView Shrink(const GroundImage& image) const;
  /// background: mean contrast of the camera's views, of their size; the floor is what differs from it: it shows
  /// through shadows and the pattern of a lamp, not through a part of the robot. Empty when the pair does not show the
  /// floor moving as told: the vehicle stands, the motion is wrong, or the floor has no structure.
  std::optional<CellVotes> Compare(const SmallView& reference, const SmallView& view, const cv::Mat& background,
                                   const Pose2& reference_from_view) const;

 private:
  ViewCellOptions options_;
};

}  // namespace floorloc
