// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/map_evidence.h"

#include <algorithm>

#include "mapbuilder/build/build_report.h"

namespace floorloc {

RectM ExtentWithLostFrames(const MapEvidence& evidence) {
  const RectM& surveyed = evidence.map.info.extent;
  const RectM& roi = evidence.map.info.camera().floor.roi;
  const double reach_m = 0.5 * std::max(surveyed.width_m(), surveyed.height_m());
  const double view_m = 0.5 * std::max(roi.width_m(), roi.height_m());
  const RectM limit{surveyed.x_min - reach_m, surveyed.x_max + reach_m, surveyed.y_min - reach_m,
                    surveyed.y_max + reach_m};
  RectM extent = surveyed;
  for (const DroppedFrame& frame : evidence.build.dropped) {
    if (!frame.near) {
      continue;
    }
    const Eigen::Vector2d at = *frame.near * roi.Center();
    if (limit.Contains(at)) {
      extent = {std::min(extent.x_min, at.x() - view_m), std::max(extent.x_max, at.x() + view_m),
                std::min(extent.y_min, at.y() - view_m), std::max(extent.y_max, at.y() + view_m)};
    }
  }
  return extent;
}

MapEvidence ReadMapEvidence(const MapDatabase& database) {
  MapEvidence evidence{database.ReadMap(), database.ReadFrames(), database.ReadLinks(), {}, {}};
  evidence.copies = FindCameraCopies(evidence.map, evidence.frames,
                                     [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  evidence.build = ParseBuildReport(evidence.map.info.report_json);
  return evidence;
}

}  // namespace floorloc
