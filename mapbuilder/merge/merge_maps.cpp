// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/merge/merge_maps.h"

#include <nlohmann/json.hpp>

#include "core/geometry/option_check.h"
#include "core/map/extractor_parameters.h"
#include "core/map/map_error.h"
#include "core/map/map_writer.h"
#include "mapbuilder/finished_map/map_info.h"
#include "mapbuilder/finished_map/map_mosaic.h"
#include "mapbuilder/finished_map/upright_descriptors.h"
#include "mapbuilder/merge/join_keypoints.h"
#include "mapbuilder/merge/map_deformation.h"
#include "mapbuilder/mosaic/mosaic.h"
#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {
namespace {

void CheckCompatible(const BaseMap& first, const BaseMap& second) {
  const auto refuse = [&](const std::string& what) {
    throw MapError(second.file.string() + " has another " + what + " than " + first.file.string() +
                   "; build one of them again with the other's");
  };
  if (ToParameters(first.map.info.extractor) != ToParameters(second.map.info.extractor)) {
    refuse("feature extractor, or other parameters of it,");
  }
  if (first.map.info.camera().floor.resolution_m != second.map.info.camera().floor.resolution_m ||
      first.map.mosaic.resolution_m != second.map.mosaic.resolution_m) {
    refuse("resolution");
  }
}

// Moves the second map's keypoints with the frames around them, and counts their positions from the first's origin.
MapKeypoints Deformed(const MapKeypoints& keypoints, const MapDeformation& deformation,
                      const Eigen::Vector2d& origin_m) {
  MapKeypoints deformed = keypoints;
  deformed.origin_m = origin_m;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    Keypoint& k = deformed.keypoints[i];
    const Pose2 motion = deformation.At(keypoints.PositionInMap(i));
    const Eigen::Vector2d p = motion * keypoints.PositionInMap(i) - origin_m;
    k.x_m = static_cast<float>(p.x());
    k.y_m = static_cast<float>(p.y());
    k.angle_rad = static_cast<float>(WrapAngle(k.angle_rad + motion.yaw()));
  }
  return deformed;
}

void WriteFramesAndLinks(const BaseMap& first, const BaseMap& second, const MapAlignment& alignment,
                         MapWriter* writer) {
  std::vector<MapFrame> frames = first.frames;
  const int first_count = static_cast<int>(frames.size());
  for (std::size_t i = 0; i < second.frames.size(); ++i) {
    MapFrame frame = second.frames[i];
    frame.survey += first.survey_count();
    frame.map_from_base = alignment.first_from_base[i];
    frames.push_back(std::move(frame));
  }
  std::vector<MapLink> links = first.links;
  for (MapLink link : second.links) {
    const Pose2& a = alignment.first_from_base[static_cast<std::size_t>(link.first)];
    const Pose2& b = alignment.first_from_base[static_cast<std::size_t>(link.second)];
    link.residual_sigma = LinkResidual(
        {link.first, link.second, link.first_from_second, link.covariance, link.inliers, link.rms_m}, a, b);
    link.first += first_count;
    link.second += first_count;
    links.push_back(link);
  }
  writer->WriteFrames(frames);
  writer->WriteLinks(links);
}

// The mosaic to be written. extent: of the floor of both maps, map frame.
struct MergedMosaic {
  RectM extent;
  MosaicLayout layout;
  MosaicOptions options;
};

// Writes the first map's mosaic over the second's, which is deformed like its frames.
void WriteMosaic(const BaseMap& first, const BaseMap& second, const MapDeformation& deformation,
                 const MergedMosaic& mosaic, MapWriter* writer) {
  const MapMosaic upper(first.database);
  const MapMosaic lower(second.database);
  const auto second_from_first = [&](const Eigen::Vector2d& p) { return deformation.OldFromNew(p); };
  const MosaicBackground both = [&](const RectM& square, int side_px) {
    const MosaicPatch a = upper.ReadPatch(square, side_px);
    const MosaicPatch b = lower.ReadPatch(square, side_px, second_from_first);
    if (a.bgr.empty() || b.bgr.empty()) {
      return a.bgr.empty() ? b : a;
    }
    return BlendOver(a, b, cv::Mat(side_px, side_px, CV_32F, cv::Scalar(1.0)));
  };
  const std::vector<BuildFrame> no_frames;
  const std::vector<LoadedSurvey> no_surveys;
  const std::vector<std::optional<Pose2>> no_poses;
  const Exposure no_exposure;
  ComposeMosaic({no_frames, no_surveys, no_poses, no_exposure, mosaic.extent, both}, mosaic.layout, mosaic.options,
                [&](const std::vector<MosaicTile>& tiles) { writer->WriteMosaicTiles(tiles); });
}

}  // namespace

void MergeOptions::Check() const {
  alignment.Check();
  lattices.Check();
  RequireOption(jpeg_quality >= 1 && jpeg_quality <= 100, "jpeg_quality must be 1 to 100");
}

MergeReport MergeMaps(const MergeOptions& options) {
  options.Check();
  const BaseMap first(options.first);
  const BaseMap second(options.second);
  CheckCompatible(first, second);
  MapWriter writer(options.out);
  const MapAlignment alignment = AlignMaps(first, second, options.alignment);
  WriteFramesAndLinks(first, second, alignment, &writer);

  const MapDeformation deformation(second, alignment.first_from_base);
  const MapKeypoints deformed = Deformed(second.map.keypoints, deformation, first.map.keypoints.origin_m);
  MapKeypoints keypoints =
      JoinKeypoints(first.map.keypoints, deformed, first.map.info.camera().floor.resolution_m, first.survey_count());
  writer.WriteKeypoints(keypoints, CreateFeatureExtractor(first.map.info.extractor)->descriptor_type());

  const CoverageGrid coverage =
      CoverageOfAll(first, {alignment.first_from_base.begin(), alignment.first_from_base.end()}, second.Floors());
  MosaicOptions mosaic;
  mosaic.tile_px = first.map.mosaic.tile_px;
  mosaic.resolution_m = first.map.mosaic.resolution_m;
  mosaic.jpeg_quality = options.jpeg_quality;
  mosaic.run = options.alignment.run;
  const MosaicLayout layout = MakeMosaicLayout(coverage.Extent(), mosaic);
  WriteMosaic(first, second, deformation, {coverage.Extent(), layout, mosaic}, &writer);
  keypoints.upright = DescribeInMosaic(keypoints,
                                       {[&](const TileId& tile) { return writer.ReadMosaicTile(tile); }, layout,
                                        first.map.info.extractor, first.map.info.camera().floor.resolution_m},
                                       options.alignment.run);
  writer.WriteUprightDescriptors(keypoints);

  MergeReport report;
  for (const BaseMap* map : {&first, &second}) {
    const std::vector<std::string> left_behind = map->LayersLeftBehind();
    report.warnings.insert(report.warnings.end(), left_behind.begin(), left_behind.end());
  }
  report.frames = static_cast<int>(first.frames.size() + second.frames.size());
  report.shared_frames = alignment.shared_frames;
  report.deformation_m = alignment.deformation_m;
  report.keypoints = static_cast<int>(keypoints.size());
  report.shared_keypoints = static_cast<int>(first.map.keypoints.size() + deformed.size() - keypoints.size());
  report.area_m2 = coverage.AreaM2();
  report.lattices = FindLatticeRegions(keypoints, options.lattices, options.alignment.seed);
  MapInfo info = MakeMergedInfo(options.out.stem().string(), first, second);
  info.extent = coverage.Extent();
  info.area_m2 = coverage.AreaM2();
  info.lattices = report.lattices;
  info.report_json = nlohmann::json{{"shared_frames", report.shared_frames},
                                    {"bent_m", report.deformation_m},
                                    {"shared_keypoints", report.shared_keypoints}}
                         .dump();
  report.content_version = writer.Commit(info, layout);
  return report;
}

}  // namespace floorloc
