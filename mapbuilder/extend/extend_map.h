// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/extend/locate_in_map.h"
#include "mapbuilder/finished_map/map_mosaic.h"
#include "mapbuilder/mosaic/mosaic.h"

namespace floorloc {

/// Attaches the fixes in the base map to their frames as priors. Throws InputError when there are too few to align the
/// surveys with it and no control points either.
FrameSet AlignToMap(const BaseMap& base_map, const std::vector<PosePriorFactor>& fixes, FrameSet set);

/// Mosaic of an extended map: new images over the old mosaic. Keeps references to its arguments.
class ExtendedMosaic {
 public:
  /// coverage: of the new frames.
  ExtendedMosaic(const BaseMap& base_map, const CoverageGrid& coverage)
      : base_mosaic_(base_map.database), base_map_(base_map), new_(coverage) {}

  MosaicBackground Background() const;
  /// Replaces tiles of the finest level that no new frame covers by the old ones, byte for byte, so that repeated
  /// extension does not degrade them by re-encoding.
  void KeepBaseTiles(const MosaicLayout& layout, std::vector<MosaicTile>* tiles) const;
  /// Layout of the old mosaic; the new one must have the same tiles and resolution.
  const MosaicLayout& layout() const { return base_mosaic_.layout(); }

 private:
  bool IsCoveredByNew(const MosaicLayout& layout, const TileId& id) const;

  MapMosaic base_mosaic_;
  const BaseMap& base_map_;
  const CoverageGrid& new_;
};

/// Smallest rectangle around both; an empty one (all zero) is ignored.
RectM Union(const RectM& a, const RectM& b);

}  // namespace floorloc
