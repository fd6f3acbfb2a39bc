// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_findings.h"

#include <iterator>
#include <map>
#include <unordered_map>

namespace floorloc {
namespace {

// Placed frames of one survey, keyed by stamp; used only where the survey has odometry.
using OdometryIndex = std::map<std::int64_t, const BuildFrame*>;

// Pose of the placed frame nearest in time, propagated to the dropped frame by odometry.
std::optional<Pose2> PoseByOdometry(const OdometryIndex& placed_frames, const PlacedSurvey& placed,
                                    const DroppedFrame& lost) {
  const Trajectory& odometry = placed.surveys[static_cast<std::size_t>(lost.survey)].survey.odometry;
  const auto odom_from_lost = lost.stamp_ns ? InterpolatePose(odometry, *lost.stamp_ns) : std::nullopt;
  if (!odom_from_lost || placed_frames.empty()) {
    return std::nullopt;
  }
  auto nearest = placed_frames.lower_bound(*lost.stamp_ns);
  if (nearest != placed_frames.begin()) {
    const auto before = std::prev(nearest);
    if (nearest == placed_frames.end() || *lost.stamp_ns - before->first < nearest->first - *lost.stamp_ns) {
      nearest = before;
    }
  }
  const auto frame = static_cast<std::size_t>(nearest->second - placed.frames.data());
  return *placed.map_from_base[frame] * placed.frames[frame].odom_from_base->Between(*odom_from_lost);
}

// Share of contradicted among agreeing links above which the report warns; floors without repetition stay below it.
constexpr double kManyRejected = 0.05;

void AddLinks(const Placement& placement, BuildReport* report) {
  report->part_sizes = placement.part_sizes;
  report->repeats_unaided = placement.repeats_unaided;
  report->links = static_cast<int>(placement.links.size());
  report->rejected_links = placement.rejected_links;
  report->overlapping_pairs = placement.overlapping_pairs;
  report->unmatched_pairs = placement.unmatched_pairs;
  report->link_rms_m = placement.rms_m;
  report->link_rms_sigma = placement.rms_sigma;
  report->drift_m = placement.drift_m;
  report->drift_rad = placement.drift_rad;
  if (placement.rejected_links > kManyRejected * static_cast<double>(placement.links.size())) {
    report->warnings.push_back(std::to_string(placement.rejected_links) +
                               " links contradict the rest; if the floor is not repetitive, the calibration may be "
                               "off: try --self-calibrate mounting,distortion");
  }
}

}  // namespace

void AddScreening(const ScreenedFrames& screened, const std::vector<std::string>& odometry, BuildReport* report) {
  report->dropped = screened.dropped;
  report->warnings = screened.warnings;
  report->warnings.insert(report->warnings.end(), odometry.begin(), odometry.end());
}

void AddPlacement(const PlacedSurveys& placed, const CalibratedFrames& calibrated, BuildReport* report) {
  const FrameSet& set = calibrated.set;
  const Placement& placement = calibrated.placement;
  const std::vector<RectM> floors = set.FloorsInBase();
  const PlacedSurvey survey{set.frames, set.surveys, placement.map_from_base, floors};
  report->frames = static_cast<int>(set.frames.size() + report->dropped.size());  // with those dropped by screening
  AddDropped(survey, placement.drop_reason, &report->dropped);
  report->frames_used = report->frames - static_cast<int>(report->dropped.size());
  report->self_calibration = calibrated.calibration;
  if (placed.height_factor) {
    report->heights.lowest *= *placed.height_factor;
    report->heights.highest *= *placed.height_factor;
    report->heights.scale_by = "control points and known distances";
  }
  report->control_points = CompareControlPoints(survey);
  report->control_point_scale = placement.control_points.scale;
  AddLinks(placement, report);
  report->extends = placed.base_file;
  report->frames_found = placed.found_in_base;
  report->warnings.insert(report->warnings.end(), placed.warnings.begin(), placed.warnings.end());
  if (placed.markers) {
    report->markers = placed.markers->Fits(set.frames, placement);
    report->warnings.insert(report->warnings.end(), placed.markers->warnings().begin(),
                            placed.markers->warnings().end());
  }
}

void AddScale(const CalibratedFrames& calibrated, const BuildOptions& options, const std::string& base_report,
              BuildReport* report) {
  report->distances = CompareDistances(calibrated, options.distances);
  ScaleContext context{report->distances, report->heights.free && report->heights.scale_by == "odometry", 0.0,
                       report->extent};
  if (!base_report.empty()) {
    context.base_sigma = ParseBuildReport(base_report).scale.sigma;
  }
  report->scale = MeasureScale(calibrated, context, options.distances, options.scale);
  for (std::string& sentence : NameMisfits(report->distances, options.distances)) {
    report->warnings.push_back(std::move(sentence));
  }
}

void AddCoverage(const CoverageGrid& coverage, BuildReport* report) {
  report->area_m2 = coverage.AreaM2();
  report->extent = coverage.Extent();
}

void AddDropped(const PlacedSurvey& placed, const std::vector<std::string>& reason,
                std::vector<DroppedFrame>* dropped) {
  std::vector<OdometryIndex> placed_frames(placed.surveys.size());
  for (std::size_t i = 0; i < placed.frames.size(); ++i) {
    const BuildFrame& frame = placed.frames[i];
    if (!placed.map_from_base[i]) {
      dropped->push_back({frame.info.filename, reason[i], std::nullopt, frame.survey, frame.info.stamp_ns});
    } else if (frame.odom_from_base) {
      placed_frames[static_cast<std::size_t>(frame.survey)].emplace(frame.info.stamp_ns, &frame);
    }
  }
  for (DroppedFrame& frame : *dropped) {
    frame.near = PoseByOdometry(placed_frames[static_cast<std::size_t>(frame.survey)], placed, frame);
  }
}

std::vector<ControlPointError> CompareControlPoints(const PlacedSurvey& placed) {
  std::vector<std::unordered_map<std::string, std::size_t>> frame_of(placed.surveys.size());
  for (std::size_t i = 0; i < placed.frames.size(); ++i) {
    frame_of[static_cast<std::size_t>(placed.frames[i].survey)].emplace(placed.frames[i].info.filename, i);
  }
  std::vector<ControlPointError> errors;
  for (std::size_t s = 0; s < placed.surveys.size(); ++s) {
    const Survey& survey = placed.surveys[s].survey;
    for (const ControlPoint& point : survey.control_points) {
      const auto frame = frame_of[s].find(point.filename);
      if (frame != frame_of[s].end() && placed.map_from_base[frame->second]) {
        const Eigen::Vector2d observed_m = *placed.map_from_base[frame->second] *
                                           FloorPointOf(placed.frames[frame->second], placed.surveys, point.raw_px);
        errors.push_back(
            {point.filename, point.point_in_map_m, observed_m, point.sigma_m.value_or(ControlPointError().sigma_m)});
      }
    }
  }
  return errors;
}

std::vector<FlatField> SampleFlatFields(const Exposure& exposure) {
  constexpr int kColumns = 16;
  std::vector<FlatField> fields;
  for (const cv::Mat& gain : exposure.flat_field) {
    FlatField field{kColumns, std::max(1, (kColumns * gain.rows + gain.cols / 2) / gain.cols), {}};
    const auto middle = static_cast<double>(gain.at<float>(gain.rows / 2, gain.cols / 2));
    for (int row = 0; row < field.rows; ++row) {
      for (int column = 0; column < field.columns; ++column) {
        const float value = gain.at<float>((2 * row + 1) * gain.rows / (2 * field.rows),
                                           (2 * column + 1) * gain.cols / (2 * field.columns));
        field.gain.push_back(static_cast<double>(value) / middle);
      }
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace floorloc
