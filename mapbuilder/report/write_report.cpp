// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/write_report.h"

#include <algorithm>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/report/report_html.h"
#include "mapbuilder/report/report_json.h"

namespace floorloc {
namespace {

// Maximum side of the mosaic in pixels, which keeps the page at a few megabytes.
constexpr double kMaxPixels = 2000.0;

MosaicImage ReadMosaic(const MapDatabase& database, const MapInfo& info) {
  const double coarsest_m = std::max(info.extent.width_m(), info.extent.height_m()) / kMaxPixels;
  return ExportMosaic(database, std::max(info.resolution_m, coarsest_m));
}

}  // namespace

void PrepareReportFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(folder, "can't be made (" + error.message() + "); give another folder for the report");
  }
  CheckWritable(folder / "report.html");
  CheckWritable(folder / "report.json");
}

Verdict AssessMapFile(const std::filesystem::path& map_file) {
  const MapEvidence evidence = ReadMapEvidence(MapDatabase(map_file));
  return AssessMap(evidence, MeasureQuality(evidence, {}));
}

Verdict WriteReport(const std::filesystem::path& map_file, const std::filesystem::path& folder) {
  const MapDatabase database(map_file);
  const MapEvidence evidence = ReadMapEvidence(database);
  const QualityOptions options;
  const MapQuality quality = MeasureQuality(evidence, options);
  Verdict verdict = AssessMap(evidence, quality);
  const MosaicImage mosaic = ReadMosaic(database, evidence.map.info);
  PrepareReportFolder(folder);
  WriteFileAtomically(folder / "report.json", ReportJson(evidence, quality, verdict));
  WriteFileAtomically(folder / "report.html", ReportHtml({evidence, quality, options, verdict, mosaic}));
  return verdict;
}

}  // namespace floorloc
