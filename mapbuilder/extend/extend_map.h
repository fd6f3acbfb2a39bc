// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/extend/locate_in_map.h"
#include "mapbuilder/finished_map/map_picture.h"
#include "mapbuilder/mosaic/mosaic.h"

namespace floorloc {

/// The frames with, for those that were found in the old map, their fix as prior. Throws InputError when there are too
/// few to align the surveys with it, and no control points either.
FrameSet AlignToMap(const OldMap& old, const std::vector<PosePriorFactor>& fixes, FrameSet set);

/// The mosaic of a map that is extended: new pictures over the old mosaic. Refers to its parts.
class ExtendedMosaic {
 public:
  /// coverage: of the new frames.
  ExtendedMosaic(const OldMap& old, const CoverageGrid& coverage) : picture_(old.database), old_(old), new_(coverage) {}

  MosaicBackground Background() const;
  /// Tiles of the finest level where no new frame looked are the old ones, byte by byte: they do not wear out by being
  /// encoded again with every extension.
  void KeepOldTiles(const MosaicLayout& layout, std::vector<MosaicTile>* tiles) const;
  /// Of the old mosaic: the new one must have its tiles and resolution.
  const MosaicLayout& layout() const { return picture_.layout(); }

 private:
  bool TouchedByNew(const MosaicLayout& layout, const TileId& id) const;

  MapPicture picture_;
  const OldMap& old_;
  const CoverageGrid& new_;
};

/// The smallest rectangle around both; one that is empty (all zero) does not count.
RectM Union(const RectM& a, const RectM& b);

}  // namespace floorloc
