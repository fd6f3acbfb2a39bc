// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/map/map_database.h"
#include "mapbuilder/mosaic/mosaic_patch.h"

namespace floorloc {

/// The finest level of a map's mosaic, to be shown in another map. Thread-safe. Refers to the database.
class MapMosaic {
 public:
  explicit MapMosaic(const MapDatabase& map) : map_(map), layout_(map.ReadMosaicLayout()) {}

  /// What the mosaic shows of a square of its own frame; a square of its own grid comes out as it is. Damaged tiles
  /// are an error (MapError).
  MosaicPatch ReadPatch(const RectM& square, int side_px) const;

  /// The same of a square of another frame. own_from_other: where a point of that frame lies in this map; smooth.
  using Warp = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;
  MosaicPatch ReadPatch(const RectM& square, int side_px, const Warp& own_from_other) const;

  const MosaicLayout& layout() const { return layout_; }

 private:
  cv::Mat ReadTiles(const Eigen::Vector2i& first, const Eigen::Vector2i& last) const;

  const MapDatabase& map_;
  MosaicLayout layout_;
};

}  // namespace floorloc
