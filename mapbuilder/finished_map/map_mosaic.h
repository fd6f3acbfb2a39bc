// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/map/map_database.h"
#include "mapbuilder/mosaic/mosaic_patch.h"

namespace floorloc {

/// Finest level of a map's mosaic, for rendering in another map. Thread-safe. Keeps a reference to the database.
class MapMosaic {
 public:
  explicit MapMosaic(const MapDatabase& map) : map_(map), layout_(map.ReadMosaicLayout()) {}

  /// Renders a square of the map's own frame; a square of its tile grid is returned unchanged. Throws MapError for
  /// damaged tiles.
  MosaicPatch ReadPatch(const RectM& square, int side_px) const;

  /// Renders a square of another frame. own_from_other: maps a point of that frame into this map; must be smooth.
  using Warp = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;
  MosaicPatch ReadPatch(const RectM& square, int side_px, const Warp& own_from_other) const;

  const MosaicLayout& layout() const { return layout_; }

 private:
  cv::Mat ReadTiles(const Eigen::Vector2i& first, const Eigen::Vector2i& last) const;

  const MapDatabase& map_;
  MosaicLayout layout_;
};

}  // namespace floorloc
