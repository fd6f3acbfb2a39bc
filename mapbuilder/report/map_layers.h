// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/report/quality.h"

namespace floorloc {

/// A layer drawn over the mosaic.
struct PageLayer {
  std::string key;  ///< for element ids, e.g. "coverage"
  std::string title;
  std::string meaning;                                      ///< one or two sentences
  std::vector<std::pair<std::string, std::string>> legend;  ///< colour, label
  std::string svg;                                          ///< in metres, y down: (x, -y)
  bool fills = false;                                       ///< opaque; only one such layer is shown at a time
  bool shown = false;                                       ///< initially
};

/// The drawn rectangle of the map: the surveyed floor with a margin.
RectM DrawnRect(const MapEvidence& evidence);

/// The mosaic with at most about 2000 pixels a side; white where there is no floor.
std::string MosaicSvg(const MosaicImage& mosaic, const MapQuality& quality);

/// All layers that the map has data for; empty ones are omitted.
std::vector<PageLayer> MakePageLayers(const MapEvidence& evidence, const MapQuality& quality,
                                      const QualityOptions& options);

/// Numbered marks of the zones.
std::string MarksSvg(const MapQuality& quality, const RectM& drawn);

}  // namespace floorloc
