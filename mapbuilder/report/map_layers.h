// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/report/quality.h"

namespace floorloc {

/// A layer that can be drawn over the mosaic.
struct PageLayer {
  std::string key;  ///< for ids, e.g. "coverage"
  std::string title;
  std::string meaning;                                      ///< one or two sentences
  std::vector<std::pair<std::string, std::string>> legend;  ///< colour, label
  std::string svg;                                          ///< in metres, y down: (x, -y)
  bool fills = false;  ///< covers the floor; only one such layer is shown at a time
  bool shown = false;  ///< at first
};

/// The rectangle of the map that is drawn: the surveyed floor with a little room.
RectM DrawnRect(const MapEvidence& evidence);

/// The mosaic with at most about 2000 pixels a side, white where there is no floor.
std::string MosaicSvg(const MosaicImage& mosaic, const MapQuality& quality);

/// Everything that the map file lets us draw; layers that would be empty are left out.
std::vector<PageLayer> MakePageLayers(const MapEvidence& evidence, const MapQuality& quality,
                                      const QualityOptions& options);

/// The numbered marks of the zones.
std::string MarksSvg(const MapQuality& quality, const RectM& drawn);

}  // namespace floorloc
