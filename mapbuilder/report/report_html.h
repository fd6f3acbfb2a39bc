// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/map_layers.h"
#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// What the page is made of.
struct ReportPage {
  const MapEvidence& evidence;
  const MapQuality& quality;
  const QualityOptions& options;
  const Verdict& verdict;
  const MosaicImage& mosaic;
};

/// One page that needs nothing but itself: verdict, what to survey again, the mosaic with layers, figures, lists.
std::string ReportHtml(const ReportPage& page);

}  // namespace floorloc
