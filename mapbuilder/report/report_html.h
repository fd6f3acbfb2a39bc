// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/map_layers.h"
#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// Input of the page.
struct ReportPage {
  const MapEvidence& evidence;
  const MapQuality& quality;
  const QualityOptions& options;
  const Verdict& verdict;
  const MosaicImage& mosaic;
};

/// Self-contained page: verdict, zones to survey again, the mosaic with layers, figures, lists.
std::string ReportHtml(const ReportPage& page);

}  // namespace floorloc
