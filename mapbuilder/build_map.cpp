// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_map.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <numeric>

#include "core/io/input_error.h"
#include "core/map/map_writer.h"
#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/build/build_findings.h"
#include "mapbuilder/build/build_report.h"
#include "mapbuilder/build/map_frames.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/extend/extend_map.h"
#include "mapbuilder/finished_map/map_info.h"
#include "mapbuilder/placement/placement_journal.h"
#include "mapbuilder/report_paths.h"
#include "mapbuilder/screening/frame_screening.h"
#include "mapbuilder/screening/odometry_agreement.h"
#include "mapbuilder/survey/frame_journal.h"

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

std::vector<RectM> FloorsInBase(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys) {
  std::vector<RectM> floors;
  for (const BuildFrame& frame : frames) {
    floors.push_back(surveys[static_cast<std::size_t>(frame.survey)].survey.camera.floor.roi);
  }
  return floors;
}

void AttachPoses(const Trajectory& poses, const PlacementOptions& options, std::vector<BuildFrame>* frames) {
  if (poses.empty()) {
    return;
  }
  const Eigen::Vector3d sigma(options.prior_sigma_m, options.prior_sigma_m, options.prior_sigma_rad);
  int attached = 0;
  for (BuildFrame& frame : *frames) {
    if (const std::optional<Pose2> pose = InterpolatePose(poses, frame.info.stamp_ns)) {
      frame.prior = {*pose, sigma.cwiseAbs2().asDiagonal()};
      ++attached;
    }
  }
  if (attached == 0) {
    throw InputError("none of the --poses lies at the time of a survey frame; check that both use the same clock");
  }
}

void FillReport(const Placement& placement, const PlacedSurvey& placed, const CoverageGrid& coverage,
                BuildReport* report) {
  report->frames =
      static_cast<int>(placed.frames.size() + report->dropped.size());  // with those the screening left out
  AddDropped(placed, placement.drop_reason, &report->dropped);
  report->frames_used = report->frames - static_cast<int>(report->dropped.size());
  report->control_points = CompareControlPoints(placed);
  report->part_sizes = placement.part_sizes;
  report->links = static_cast<int>(placement.links.size());
  report->rejected_links = placement.rejected_links;
  report->overlapping_pairs = placement.overlapping_pairs;
  report->unmatched_pairs = placement.unmatched_pairs;
  report->link_rms_m = placement.rms_m;
  report->link_rms_sigma = placement.rms_sigma;
  report->drift_m = placement.drift_m;
  report->drift_rad = placement.drift_rad;
  constexpr double kManyRejected = 0.05;
  if (placement.rejected_links > kManyRejected * static_cast<double>(placement.links.size())) {
    report->warnings.push_back(
        std::to_string(placement.rejected_links) +
        " links contradict the rest; if the floor does not repeat itself, the calibration may be "
        "off: try --self-calibrate mounting,distortion");
  }
  report->area_m2 = coverage.AreaM2();
  report->extent = coverage.Extent();
}

std::unique_ptr<OldMap> OpenOldMap(const std::filesystem::path& file) {
  return file.empty() ? nullptr : std::make_unique<OldMap>(file);
}

// The keys of what is done once all features are known.
std::string KeyOf(const char* stage, const BuildOptions& options, const std::vector<LoadedSurvey>& surveys) {
  return PlacementKey(surveys, stage + options.fingerprint, options.poses);
}

// Finds the frames in the old map, unless an earlier run of this build did.
void TieToOldMap(const OldMap& old, const std::vector<LoadedSurvey>& surveys, const BuildOptions& options,
                 BuildJournal* journal, std::vector<BuildFrame>* frames, BuildReport* report) {
  const std::string key = KeyOf("fixes", options, surveys);
  auto fixes = RestoreFixes(key, frames->size(), journal);
  if (!fixes) {
    fixes = LocateInMap(old, surveys, *frames, {options.threads, options.seed, options.progress});
    StoreFixes(*fixes, key, journal);
  }
  report->extends = old.file.filename().string();
  report->frames_found = static_cast<int>(fixes->size());
  TieToMap(old, surveys, *fixes, frames);
}

// As PlaceFrames, unless an earlier run of this build did it.
Placement PlaceFramesOnce(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                          const BuildOptions& options, BuildJournal* journal) {
  const std::string key = KeyOf("placement", options, surveys);
  if (std::optional<Placement> done = RestorePlacement(key, frames.size(), journal)) {
    return std::move(*done);
  }
  Placement placement = PlaceFrames(frames, surveys, options.placement);
  StorePlacement(placement, key, journal);
  return placement;
}

// Finds the markers, hides them from the map and lets them say where the frames are.
std::optional<MarkerSurvey> UseMarkers(const BuildOptions& options, std::vector<LoadedSurvey>* surveys,
                                       std::vector<BuildFrame>* frames) {
  if (options.markers.file.empty()) {
    return std::nullopt;
  }
  MarkerOptions with_shared = options.markers;
  with_shared.detection.threads = options.threads;
  with_shared.detection.progress = options.progress;
  MarkerSurvey markers(with_shared, *surveys, *frames);
  markers.MaskSeen(frames);
  markers.AddControlPoints(*frames, surveys);
  return markers;
}

// Places the frames; once more when a marker turns out to be wrong.
Placement PlaceWithMarkers(const BuildOptions& options, std::vector<LoadedSurvey>* surveys, BuildJournal* journal,
                           std::vector<BuildFrame>* frames, MarkerSurvey* markers) {
  Placement placement = PlaceFramesOnce(*frames, *surveys, options, journal);
  if (markers->LeaveOutContradicting(*frames, placement, surveys)) {
    BuildOptions without = options;
    without.fingerprint += "contradicting markers left out\n";
    placement = PlaceFramesOnce(*frames, *surveys, without, journal);
  }
  markers->MaskInMap(placement, frames);
  return placement;
}

void Screen(std::vector<LoadedSurvey>* surveys, const PairRegistrationOptions& registration,
            std::vector<BuildFrame>* frames, BuildReport* report) {
  Screening screening = ScreenFrames(surveys, registration, frames);
  report->dropped = std::move(screening.dropped);
  report->warnings = std::move(screening.warnings);
  for (std::string& warning : CheckOdometry(*frames, *surveys, registration)) {
    report->warnings.push_back(std::move(warning));
  }
}

// The stages' options with what all of them share filled in.
BuildOptions WithSharedOptions(BuildOptions options, const std::vector<LoadedSurvey>& surveys, const OldMap* old) {
  if (old != nullptr) {
    options.fingerprint += old->map.info.content_version;
    options.extractor = old->map.info.extractor;
    options.mosaic.tile_px = old->map.mosaic.tile_px;
    options.mosaic.resolution_m = old->map.mosaic.resolution_m;
  }
  options.placement.registration.threads = options.threads;
  options.placement.registration.progress = options.progress;
  const FloorPlane& floor = surveys.front().survey.camera.floor;
  options.placement.registration.resolution_m = floor.resolution_m;
  options.fusion = options.fusion.ForCamera(floor, options.extractor.max_keypoints);
  if (options.max_keypoints_per_m2 > 0.0) {
    options.fusion.pruning.max_per_m2 = options.max_keypoints_per_m2;
  }
  options.fusion.threads = options.threads;
  options.fusion.seed = options.seed;
  options.placement.registration.registration.seed = options.seed;
  options.self_calibration.registration = options.placement.registration;
  options.held_out.extractor = options.extractor;
  options.held_out.fusion = options.fusion;
  options.held_out.threads = options.threads;
  options.mosaic.threads = options.threads;
  options.mosaic.progress = options.progress;
  if (options.mosaic.resolution_m <= 0.0) {
    options.mosaic.resolution_m = surveys.front().survey.camera.floor.resolution_m;
  }
  return options;
}

FusionInput FusionOf(const std::vector<BuildFrame>& frames, const Placement& placement,
                     const std::vector<RectM>& floors, const OldMap* old) {
  if (old == nullptr) {
    return {frames, placement.map_from_base, floors};
  }
  return {frames, placement.map_from_base, floors, &old->map.keypoints, &old->coverage, old->survey_count()};
}

void CountKeypoints(const MapKeypoints& keypoints, BuildReport* report) {
  report->keypoints = static_cast<int>(keypoints.size());
  report->mean_observations = std::accumulate(keypoints.observations.begin(), keypoints.observations.end(), 0.0) /
                              std::max<double>(1.0, static_cast<double>(keypoints.size()));
}

MapInfo Completed(MapInfo info, const BuildOptions& options, const BuildReport& report) {
  info.extractor = options.extractor;
  info.extent = report.extent;
  info.area_m2 = report.area_m2;
  info.report_json = ToJson(WithoutFolders(report, options.surveys, options.markers.file), false);
  return info;
}

void ComposeInto(MapWriter* writer, const MosaicInput& input, const MosaicLayout& layout, const MosaicOptions& options,
                 const ExtendedMosaic* extended) {
  ComposeMosaic(input, layout, options, [&](std::vector<MosaicTile> tiles) {
    if (extended != nullptr) {
      extended->KeepOldTiles(layout, &tiles);
    }
    writer->WriteMosaicTiles(tiles);
  });
}

}  // namespace

BuildReport BuildMap(const BuildOptions& requested) {
  BuildReport report;
  StageClock clock(&report);
  const std::unique_ptr<OldMap> old = OpenOldMap(requested.extend);
  std::vector<LoadedSurvey> surveys =
      LoadSurveys(requested.surveys, BadFrames::kLeaveOut, old ? old->map.info.camera().floor.resolution_m : 0.0);
  const BuildOptions options = WithSharedOptions(requested, surveys, old.get());
  MapWriter writer(options.out);  // first: an output that can't be written is known before the work
  BuildJournal journal(BuildJournal::FileFor(options.out), options.resume, options.progress.stream);

  FrameJournal frame_journal(&journal, surveys, options.extractor);
  std::vector<BuildFrame> frames = ExtractSurveyFrames(
      surveys, {options.extractor, options.threads, options.progress, &frame_journal, BadFrames::kLeaveOut});
  report.resumed_frames = frame_journal.restored();
  Screen(&surveys, options.placement.registration, &frames, &report);
  AttachPoses(options.poses, options.placement, &frames);
  std::optional<MarkerSurvey> markers = UseMarkers(options, &surveys, &frames);
  clock.Finish("features");

  const std::vector<RectM> floors = FloorsInBase(frames, surveys);
  if (old) {
    const std::vector<std::string> left_behind = old->LayersLeftBehind();
    report.warnings.insert(report.warnings.end(), left_behind.begin(), left_behind.end());
    TieToOldMap(*old, surveys, options, &journal, &frames, &report);
  }
  Placement placement = markers ? PlaceWithMarkers(options, &surveys, &journal, &frames, &*markers)
                                : PlaceFramesOnce(frames, surveys, options, &journal);
  report.self_calibration = SelfCalibrate({&frames, &surveys, &placement}, options.self_calibration);
  const CoverageGrid new_coverage(placement.map_from_base, floors);
  const CoverageGrid coverage = old ? CoverageOfAll(*old, placement.map_from_base, floors) : new_coverage;
  report.kept_all = options.placement.keep_all;
  const PlacedSurvey placed_survey{frames, surveys, placement.map_from_base, floors};
  FillReport(placement, placed_survey, coverage, &report);
  if (markers) {
    report.markers = markers->Fits(frames, placement);
    report.warnings.insert(report.warnings.end(), markers->warnings().begin(), markers->warnings().end());
  }
  clock.Finish("poses");

  const MapKeypoints keypoints = FuseKeypoints(FusionOf(frames, placement, floors, old.get()), options.fusion);
  CountKeypoints(keypoints, &report);
  writer.WriteKeypoints(keypoints, CreateFeatureExtractor(options.extractor)->descriptor_type());
  clock.Finish("keypoints");

  if (options.hold_out) {
    report.held_out = LocalizeHeldOut(placed_survey, options.held_out);
    clock.Finish("held-out");
  }

  const auto extended = old ? std::make_unique<ExtendedMosaic>(*old, new_coverage) : nullptr;
  const MosaicBackground background = extended ? extended->Background() : nullptr;
  const Exposure exposure =
      EstimateExposure({frames, surveys, placement.links, placement.map_from_base, background, options.threads});
  report.flat_fields = SampleFlatFields(exposure);
  const PlacedFrames placed = CollectPlaced(frames, placement, exposure, old.get());
  writer.WriteFrames(placed.frames);
  writer.WriteLinks(placed.links);
  const MosaicLayout layout = MakeMosaicLayout(coverage.Extent(), options.mosaic);
  const MosaicInput input{frames, surveys, placement.map_from_base, exposure, coverage.Extent(), background};
  ComposeInto(&writer, input, layout, options.mosaic, extended.get());
  clock.Finish("mosaic");

  const MapInfo info = MakeMapInfo(options.out.stem().string(), surveys, old.get());
  report.content_version = writer.Commit(Completed(info, options, report), layout);
  journal.Remove();
  clock.Finish("write");
  return report;
}

}  // namespace floorloc
