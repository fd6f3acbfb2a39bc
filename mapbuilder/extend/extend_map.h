// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/extend/locate_in_map.h"
#include "mapbuilder/finished_map/map_mosaic.h"
#include "mapbuilder/mosaic/mosaic.h"

namespace floorloc {

/// The frames with, for those that were found in the base map, their fix as prior. Throws InputError when there are too
/// few to align the surveys with it, and no control points either.
FrameSet AlignToMap(const BaseMap& base_map, const std::vector<PosePriorFactor>& fixes, FrameSet set);

/// The mosaic of a map that is extended: new images over the old mosaic. Refers to its parts.
class ExtendedMosaic {
 public:
  /// coverage: of the new frames.
  ExtendedMosaic(const BaseMap& base_map, const CoverageGrid& coverage)
      : base_mosaic_(base_map.database), base_map_(base_map), new_(coverage) {}

  MosaicBackground Background() const;
  /// Tiles of the finest level where no new frame covers them are the old ones, byte by byte: they do not degrade by
  /// being encoded again with every extension.
  void KeepBaseTiles(const MosaicLayout& layout, std::vector<MosaicTile>* tiles) const;
  /// Of the old mosaic: the new one must have its tiles and resolution.
  const MosaicLayout& layout() const { return base_mosaic_.layout(); }

 private:
  bool IsCoveredByNew(const MosaicLayout& layout, const TileId& id) const;

  MapMosaic base_mosaic_;
  const BaseMap& base_map_;
  const CoverageGrid& new_;
};

/// The smallest rectangle around both; one that is empty (all zero) does not count.
RectM Union(const RectM& a, const RectM& b);

}  // namespace floorloc
