// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_map.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <numeric>

#include "core/io/camera_mask.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/lattice/lattice_regions.h"
#include "core/map/camera_correction.h"
#include "core/map/camera_mask_table.h"
#include "core/map/map_writer.h"
#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/build/build_findings.h"
#include "mapbuilder/build/map_frames.h"
#include "mapbuilder/build/place_surveys.h"
#include "mapbuilder/build/report_paths.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/extend/extend_map.h"
#include "mapbuilder/finished_map/map_info.h"
#include "mapbuilder/finished_map/upright_descriptors.h"
#include "mapbuilder/screening/frame_screening.h"
#include "mapbuilder/screening/odometry_agreement.h"
#include "mapbuilder/self_calibration/camera_doubt.h"
#include "mapbuilder/survey/extract_frames.h"
#include "mapbuilder/survey/frame_journal.h"
#include "mapbuilder/survey/survey_texture.h"

namespace floorloc {
namespace {

class StageClock {
 public:
  explicit StageClock(BuildReport* report) : report_(report) {}
  void Finish(const char* stage) {
    const auto now = std::chrono::steady_clock::now();
    report_->stage_s.emplace_back(stage, std::chrono::duration<double>(now - start_).count());
    report_->total_s += report_->stage_s.back().second;
    start_ = now;
  }

 private:
  BuildReport* report_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::unique_ptr<BaseMap> OpenBaseMap(const std::filesystem::path& file) {
  return file.empty() ? nullptr : std::make_unique<BaseMap>(file);
}

// The given mask for all surveys.
void ApplyGivenMask(const std::filesystem::path& file, std::vector<LoadedSurvey>* surveys) {
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(file);
  for (LoadedSurvey& loaded : *surveys) {
    const cv::Mat mask = DecodeCameraMask(bytes, loaded.survey.camera.camera, file);
    loaded = WithMask(std::move(loaded), mask);
  }
}

// Surveys at the base map's resolution; cameras that it knows are corrected as its surveys corrected them.
std::vector<LoadedSurvey> LoadSurveysFor(const BuildOptions& options, const BaseMap* base) {
  if (base == nullptr) {
    return LoadSurveys(options.surveys, BadFramePolicy::kSkip);
  }
  const MapInfo& info = base->map.info;
  std::vector<LoadedSurvey> surveys =
      LoadSurveys(options.surveys, BadFramePolicy::kSkip, info.camera().floor.resolution_m);
  for (LoadedSurvey& loaded : surveys) {
    loaded.survey.camera = CorrectedOrGiven(info, loaded.given_camera);
    if (loaded.survey.mask.empty()) {
      loaded.survey.mask = MaskOfCamera(info, loaded.given_camera);
    }
    loaded.rectifier = std::make_shared<Rectifier>(loaded.survey.camera, loaded.survey.mask);
  }
  return surveys;
}

void FillInSigmas(double sigma_m, std::vector<LoadedSurvey>* surveys) {
  for (LoadedSurvey& loaded : *surveys) {
    for (ControlPoint& point : loaded.survey.control_points) {
      point.sigma_m = point.sigma_m.value_or(sigma_m);
    }
  }
}

// Frames of a survey with their features, and how many of them were restored from the journal of an earlier run.
struct ExtractedFrames {
  FrameSet set;
  int restored = 0;
};

ExtractedFrames ExtractFrames(std::vector<LoadedSurvey> surveys, const BuildOptions& options, BuildJournal* journal) {
  FrameJournal done(journal, surveys, options.extractor);
  std::vector<BuildFrame> frames =
      ExtractSurveyFrames(surveys, {options.extractor, options.run, &done, BadFramePolicy::kSkip});
  return {{std::move(surveys), std::move(frames)}, done.restored()};
}

// Extracts the frames of surveys anew in which a mask was found, so that their keypoints are spread over the floor
// alone and nothing that is masked has a share in them: as with a mask.png.
FrameSet ExtractMasked(FrameSet set, const std::vector<CameraMaskFinding>& findings, const BuildOptions& options,
                       BuildJournal* journal) {
  for (std::size_t survey = 0; survey < findings.size(); ++survey) {
    if (findings[survey].status != CameraMaskStatus::kFound || !findings[survey].applied) {
      continue;
    }
    set.surveys[survey] = WithMask(std::move(set.surveys[survey]), findings[survey].mask);
    FrameSet masked = ExtractFrames({set.surveys[survey]}, options, journal).set;
    auto next = masked.frames.begin();
    for (BuildFrame& frame : set.frames) {
      if (frame.survey == static_cast<int>(survey)) {
        frame = std::move(*next++);
        frame.survey = static_cast<int>(survey);
      }
    }
  }
  return set;
}

// Warnings, one sentence each.
std::vector<std::string> CheckAndMendOdometry(const BuildOptions& options, FrameSet* set) {
  const PairRegistrationOptions& registration = options.placement.registration;
  std::vector<std::string> warnings = MendOdometryClock(registration, options.odometry_clock, set);
  const std::vector<std::string> disagreeing = CheckOdometry(*set, registration);
  warnings.insert(warnings.end(), disagreeing.begin(), disagreeing.end());
  const std::vector<std::string> left_out = MendOdometry(registration, options.odometry_steps, set);
  warnings.insert(warnings.end(), left_out.begin(), left_out.end());
  return warnings;
}

// What placement builds on, besides the frames.
struct BuildSoFar {
  const BaseMap* base;  // nullptr: none
  BuildJournal* journal;
  const FrameHeights& heights;
};

// One camera over one height is what maps are extended by.
FrameHeights FindHeightsUnlessExtending(const BuildOptions& options, const BaseMap* base, FrameSet* set) {
  const HeightSources sources{options.extractor, options.placement.registration, options.poses};
  return base == nullptr ? FindHeights(options.heights, sources, set) : FrameHeights();
}

// Uneven heights are the cause of what placement sees as missing overlap or a repeating floor.
PlacedSurveys PlaceOrNameHeights(FrameSet set, const BuildOptions& options, const BuildSoFar& so_far) {
  try {
    return PlaceSurveys(std::move(set), options, so_far.base, so_far.journal);
  } catch (const InputError& error) {
    if (so_far.heights.spread > 0.0 && !so_far.heights.free) {
      throw InputError(HeightWarning(so_far.heights) + " (" + error.what() + ")");
    }
    throw;
  }
}

// Measured distances are between places of the map as it is without them.
CalibratedFrames Calibrate(PlacedSurveys* placed, const BuildOptions& options) {
  if (!options.distances.distances.empty()) {
    const CalibratedFrames map = SelfCalibrate(placed->set, placed->placement, options.self_calibration);
    placed->set = WithMeasuredDistances(std::move(placed->set), map, options.distances);
  }
  return SelfCalibrate(std::move(placed->set), std::move(placed->placement), options.self_calibration);
}

// Placed frames and the floor that they cover.
struct SurveyedFloor {
  SurveyedFloor(CalibratedFrames calibrated, const BaseMap* base_map)
      : frames(std::move(calibrated)),
        base(base_map),
        floor_in_base(frames.set.FloorsInBase()),
        coverage(frames.placement.map_from_base, floor_in_base),
        map_coverage(base == nullptr ? coverage : CoverageOfAll(*base, frames.placement.map_from_base, floor_in_base)) {
  }

  PlacedSurvey Placed() const {
    return {frames.set.frames, frames.set.surveys, frames.placement.map_from_base, floor_in_base};
  }
  KeypointFusionInput ForFusion() const {
    KeypointFusionInput input{frames.set.frames, frames.placement.map_from_base, floor_in_base};
    if (base != nullptr) {
      return {input.frames,         input.map_from_base, input.floor_in_base,
              &base->map.keypoints, &base->coverage,     base->survey_count()};
    }
    return input;
  }

  CalibratedFrames frames;
  const BaseMap* base;  // nullptr: none
  std::vector<RectM> floor_in_base;
  CoverageGrid coverage;      // of the new frames
  CoverageGrid map_coverage;  // of the new frames and the base map
};

void CountKeypoints(const MapKeypoints& keypoints, BuildReport* report) {
  report->keypoints = static_cast<int>(keypoints.size());
  report->mean_observations = std::accumulate(keypoints.observations.begin(), keypoints.observations.end(), 0.0) /
                              std::max<double>(1.0, static_cast<double>(keypoints.size()));
}

// The masks that the map was built with, after those of the base map.
void AddMasks(const std::vector<CameraMaskFinding>& findings, MapInfo* info) {
  info->masks.resize(info->cameras.size() - findings.size());
  for (const CameraMaskFinding& finding : findings) {
    info->masks.push_back(finding.applied
                              ? MapCameraMask{finding.mask, finding.status == CameraMaskStatus::kFound, finding.picture}
                              : MapCameraMask{});
  }
}

// What the floors of the surveys look like, after those of the base map.
void AddFloorTextures(const FrameSet& set, MapInfo* info) {
  const std::vector<MapFloorTexture> textures = FloorTexturesOf(set);
  info->floor_textures.insert(info->floor_textures.end(), textures.begin(), textures.end());
}

MapInfo Completed(MapInfo info, const BuildOptions& options, const BuildReport& report) {
  AddMasks(report.masks, &info);
  info.extractor = options.extractor;
  info.extent = report.extent;
  info.area_m2 = report.area_m2;
  info.lattices = report.lattices;
  info.report_json = ToJson(WithoutFolders(report, options.surveys, options.markers.file), false);
  return info;
}

// Writes frames, links and mosaic; returns the mosaic's layout.
MosaicLayout WriteFramesAndMosaic(const SurveyedFloor& floor, const MosaicOptions& options, MapWriter* writer,
                                  BuildReport* report) {
  const auto& [set, placement, calibration] = floor.frames;
  const auto extended = floor.base != nullptr ? std::make_unique<ExtendedMosaic>(*floor.base, floor.coverage) : nullptr;
  const MosaicBackground background = extended ? extended->Background() : nullptr;
  const Exposure exposure =
      EstimateExposure({set.frames, set.surveys, placement.links, placement.map_from_base, background, options.run});
  report->flat_fields = SampleFlatFields(exposure);
  const MapFramesAndLinks placed = CollectMapFrames(set.frames, placement, exposure, floor.base);
  writer->WriteFrames(placed.frames);
  writer->WriteLinks(placed.links);
  const MosaicLayout layout = MakeMosaicLayout(floor.map_coverage.Extent(), options);
  const MosaicInput input{set.frames, set.surveys, placement.map_from_base, exposure, floor.map_coverage.Extent(),
                          background};
  ComposeMosaic(input, layout, options, [&](std::vector<MosaicTile> tiles) {
    if (extended) {
      extended->KeepBaseTiles(layout, &tiles);
    }
    writer->WriteMosaicTiles(tiles);
  });
  return layout;
}

}  // namespace

BuildReport BuildMap(const BuildOptions& requested) {
  requested.Check();
  BuildReport report;
  StageClock clock(&report);
  const std::unique_ptr<BaseMap> base = OpenBaseMap(requested.extend);
  std::vector<LoadedSurvey> surveys = LoadSurveysFor(requested, base.get());
  FillInSigmas(requested.control_point_sigma_m, &surveys);
  if (!requested.mask.empty()) {
    ApplyGivenMask(requested.mask, &surveys);
  }
  const BuildOptions options = WithSharedOptions(requested, surveys, base.get());
  MapWriter writer(options.out);  // first, so that an unwritable output fails before the work is done
  BuildJournal journal(BuildJournal::FileFor(options.out), options.resume, options.run.progress.stream);

  ExtractedFrames extracted = ExtractFrames(std::move(surveys), options, &journal);
  report.resumed_frames = extracted.restored;
  report.masks = FindCameraMasks(extracted.set, options.placement.registration, options.auto_mask);
  ScreenedFrames screened = ScreenFrames(ExtractMasked(std::move(extracted.set), report.masks, options, &journal),
                                         options.placement.registration);
  report.heights = FindHeightsUnlessExtending(options, base.get(), &screened.kept);
  AddScreening(screened, CheckAndMendOdometry(options, &screened.kept), &report);
  clock.Finish("features");

  PlacedSurveys placed = PlaceOrNameHeights(std::move(screened.kept), options, {base.get(), &journal, report.heights});
  const SurveyedFloor floor(Calibrate(&placed, options), base.get());
  if (base == nullptr && !options.self_calibration.automatic) {
    report.camera_doubt = DoubtCameras(floor.frames, options.self_calibration);
  }
  report.kept_all = options.placement.keep_all;
  AddPlacement(placed, floor.frames, &report);
  AddCoverage(floor.map_coverage, &report);
  AddScale(floor.frames, options, base ? base->map.info.report_json : "", &report);
  clock.Finish("poses");

  MapKeypoints keypoints = FuseKeypoints(floor.ForFusion(), options.fusion);
  CountKeypoints(keypoints, &report);
  report.lattices = FindLatticeRegions(keypoints, options.lattices, options.seed);
  writer.WriteKeypoints(keypoints, CreateFeatureExtractor(options.extractor)->descriptor_type());
  clock.Finish("keypoints");

  if (options.hold_out) {
    report.held_out = LocalizeHeldOut(floor.Placed(), options.held_out);
    clock.Finish("held-out");
  }

  const MosaicLayout layout = WriteFramesAndMosaic(floor, options.mosaic, &writer, &report);
  keypoints.upright =
      DescribeInMosaic(keypoints,
                       {[&](const TileId& tile) { return writer.ReadMosaicTile(tile); }, layout, options.extractor,
                        floor.frames.set.surveys.front().survey.camera.floor.resolution_m},
                       options.run);
  writer.WriteUprightDescriptors(keypoints);
  clock.Finish("mosaic");

  MapInfo info = MakeMapInfo(options.out.stem().string(), floor.frames.set.surveys, base.get());
  AddFloorTextures(floor.frames.set, &info);
  report.content_version = writer.Commit(Completed(std::move(info), options, report), layout);
  journal.Remove();
  clock.Finish("write");
  return report;
}

}  // namespace floorloc
