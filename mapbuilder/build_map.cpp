// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build_map.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/map/map_writer.h"
#include "mapbuilder/build_journal.h"
#include "mapbuilder/build_report.h"
#include "mapbuilder/coverage.h"
#include "mapbuilder/frame_journal.h"
#include "mapbuilder/frame_screening.h"
#include "mapbuilder/odometry_agreement.h"
#include "mapbuilder/placement_journal.h"

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

std::string NewUuid() {
  std::string uuid = ReadTextFile("/proc/sys/kernel/random/uuid");
  std::erase(uuid, '\n');
  return uuid;
}

std::string UtcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::vector<RectM> FloorsInBase(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys) {
  std::vector<RectM> floors;
  for (const BuildFrame& frame : frames) {
    floors.push_back(surveys[static_cast<std::size_t>(frame.survey)].survey.camera.floor.roi);
  }
  return floors;
}

void AttachPoses(const Trajectory& poses, std::vector<BuildFrame>* frames) {
  if (poses.empty()) {
    return;
  }
  int attached = 0;
  for (BuildFrame& frame : *frames) {
    frame.prior_map_from_base = InterpolatePose(poses, frame.info.stamp_ns);
    attached += frame.prior_map_from_base ? 1 : 0;
  }
  if (attached == 0) {
    throw InputError("none of the --poses lies at the time of a survey frame; check that both use the same clock");
  }
}

MapInfo MakeInfo(const BuildOptions& options, const std::vector<LoadedSurvey>& surveys, const CoverageGrid& coverage,
                 const BuildReport& report) {
  MapInfo info;
  info.builder_version = FLOORLOC_VERSION;
  info.id = NewUuid();
  info.name = options.out.stem().string();
  info.created = UtcNow();
  info.extent = coverage.Extent();
  info.area_m2 = coverage.AreaM2();
  info.extractor = options.extractor;
  nlohmann::ordered_json provenance = nlohmann::json::array();
  for (const LoadedSurvey& loaded : surveys) {
    const Survey& survey = loaded.survey;
    info.cameras.push_back(survey.camera);
    provenance.push_back({{"folder", std::filesystem::absolute(survey.folder).lexically_normal().filename().string()},
                          {"camera", survey.camera.camera.name},
                          {"frames", survey.frames.size()},
                          {"first_stamp", FormatSeconds(survey.frames.front().stamp_ns)},
                          {"odometry", !survey.odometry.empty()},
                          {"control_points", survey.control_points.size()}});
  }
  info.surveys_json = provenance.dump();
  info.report_json = ToJson(report, false);
  return info;
}

void FillReport(const Placement& placement, const std::vector<BuildFrame>& frames, const CoverageGrid& coverage,
                BuildReport* report) {
  report->frames = static_cast<int>(frames.size() + report->dropped.size());  // with those the screening left out
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (placement.map_from_base[i]) {
      ++report->frames_used;
    } else {
      report->dropped.emplace_back(frames[i].info.filename, placement.drop_reason[i]);
    }
  }
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

// What the map file keeps of the placed frames: those that were dropped get no number.
struct PlacedFrames {
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
};

PlacedFrames CollectPlaced(const std::vector<BuildFrame>& frames, const Placement& placement,
                           const Exposure& exposure) {
  PlacedFrames placed;
  std::vector<int> number(frames.size(), -1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (placement.map_from_base[i]) {
      number[i] = static_cast<int>(placed.frames.size());
      placed.frames.push_back({frames[i].info.stamp_ns, frames[i].info.filename, *placement.map_from_base[i],
                               frames[i].survey, exposure.frame_gain[i], frames[i].odom_from_base});
    }
  }
  for (const Link& link : placement.links) {
    const auto first = static_cast<std::size_t>(link.first);
    const auto second = static_cast<std::size_t>(link.second);
    if (number[first] >= 0 && number[second] >= 0) {
      placed.links.push_back({number[first], number[second], link.first_from_second, link.covariance, link.inliers,
                              link.rms_m,
                              LinkResidual(link, *placement.map_from_base[first], *placement.map_from_base[second])});
    }
  }
  return placed;
}

// As PlaceFrames, unless an earlier run of this build did it.
Placement PlaceFramesOnce(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                          const BuildOptions& options, BuildJournal* journal) {
  const std::string key = PlacementKey(surveys, options.fingerprint, options.poses);
  if (std::optional<Placement> done = RestorePlacement(key, journal)) {
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
BuildOptions WithSharedOptions(BuildOptions options, const std::vector<LoadedSurvey>& surveys) {
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
  options.self_calibration.prior_sigma_m = options.placement.prior_sigma_m;
  options.self_calibration.prior_sigma_rad = options.placement.prior_sigma_rad;
  options.mosaic.threads = options.threads;
  options.mosaic.progress = options.progress;
  if (options.mosaic.resolution_m <= 0.0) {
    options.mosaic.resolution_m = surveys.front().survey.camera.floor.resolution_m;
  }
  return options;
}

}  // namespace

BuildReport BuildMap(const BuildOptions& requested) {
  BuildReport report;
  StageClock clock(&report);
  std::vector<LoadedSurvey> surveys = LoadSurveys(requested.surveys, BadFrames::kLeaveOut);
  const BuildOptions options = WithSharedOptions(requested, surveys);
  MapWriter writer(options.out);  // first: an output that can't be written is known before the work

  BuildJournal journal(BuildJournal::FileFor(options.out), options.resume, options.progress.stream);

  FrameJournal frame_journal(&journal, surveys, options.extractor);
  std::vector<BuildFrame> frames = ExtractSurveyFrames(
      surveys, {options.extractor, options.threads, options.progress, &frame_journal, BadFrames::kLeaveOut});
  report.resumed_frames = frame_journal.restored();
  Screen(&surveys, options.placement.registration, &frames, &report);
  AttachPoses(options.poses, &frames);
  std::optional<MarkerSurvey> markers = UseMarkers(options, &surveys, &frames);
  clock.Finish("features");

  const std::vector<RectM> floors = FloorsInBase(frames, surveys);
  Placement placement = markers ? PlaceWithMarkers(options, &surveys, &journal, &frames, &*markers)
                                : PlaceFramesOnce(frames, surveys, options, &journal);
  report.self_calibration = SelfCalibrate({&frames, &surveys, &placement}, options.self_calibration);
  const CoverageGrid coverage(placement.map_from_base, floors);
  report.kept_all = options.placement.keep_all;
  FillReport(placement, frames, coverage, &report);
  if (markers) {
    report.markers = markers->Fits(frames, placement);
    report.warnings.insert(report.warnings.end(), markers->warnings().begin(), markers->warnings().end());
  }
  clock.Finish("poses");

  const MapKeypoints keypoints = FuseKeypoints({frames, placement.map_from_base, floors}, options.fusion);
  report.keypoints = static_cast<int>(keypoints.size());
  report.mean_observations = std::accumulate(keypoints.observations.begin(), keypoints.observations.end(), 0.0) /
                             std::max<double>(1.0, static_cast<double>(keypoints.size()));
  writer.WriteKeypoints(keypoints, CreateFeatureExtractor(options.extractor)->descriptor_type());
  clock.Finish("keypoints");

  const Exposure exposure =
      EstimateExposure({frames, surveys, placement.links, placement.map_from_base, nullptr, options.threads});
  const PlacedFrames placed = CollectPlaced(frames, placement, exposure);
  writer.WriteFrames(placed.frames);
  writer.WriteLinks(placed.links);
  const MosaicInput input{frames, surveys, placement.map_from_base, exposure, coverage.Extent()};
  const MosaicLayout layout = MakeMosaicLayout(coverage.Extent(), options.mosaic);
  ComposeMosaic(input, layout, options.mosaic,
                [&](const std::vector<MosaicTile>& tiles) { writer.WriteMosaicTiles(tiles); });
  clock.Finish("mosaic");

  report.content_version = writer.Commit(MakeInfo(options, surveys, coverage, report), layout);
  journal.Remove();
  clock.Finish("write");
  return report;
}

}  // namespace floorloc
