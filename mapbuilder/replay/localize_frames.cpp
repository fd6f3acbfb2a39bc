// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/localize_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/jpeg_quality.h"
#include "core/io/text_file.h"
#include "core/io/trajectory_twist.h"
#include "core/localization/stopwatch.h"
#include "core/map/camera_correction.h"
#include "core/map/camera_mask_table.h"
#include "core/tracking/readout_estimator.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// A folder's frames, each of which is localized without the others.
struct IndependentFrames {
  const Localizer& localizer;
  const Rectifier& rectifier;
  const Survey& survey;
  std::optional<ReadoutMeasurement> readout = {};  // of a camera that does not tell its own

  LocalizedFrame Localize(const SurveyFrame& frame, const std::optional<PosePrior>& prior) const {
    LocalizedFrame localized;
    localized.frame = frame;
    const FrameHints hints{
        .prior = prior, .motion = {TwistAt(survey.odometry, frame.stamp_ns), readout}, .anywhere = false};
    LocateFrame(localizer, rectifier, survey, hints, &localized);
    return localized;
  }
  // Every n-th frame, so that they are some `count` ones.
  std::vector<SurveyFrame> Some(std::size_t count) const {
    std::vector<SurveyFrame> some;
    for (std::size_t i = 0; i < survey.frames.size(); i += std::max<std::size_t>(1, survey.frames.size() / count)) {
      some.push_back(survey.frames[i]);
    }
    return some;
  }
};

bool Found(const LocalizedFrame& frame) { return frame.result.status == LocalizationStatus::kLocalized; }

// By some of the frames, so that not each of them has to be measured, which takes twice as long and knows less.
std::optional<ReadoutMeasurement> LearnReadout(const IndependentFrames& frames) {
  constexpr std::size_t kFrames = 30;
  constexpr int kEnough = 16;
  if (frames.survey.camera.camera.readout.seconds || frames.survey.odometry.empty()) {
    return std::nullopt;
  }
  ReadoutEstimator readout;
  for (const SurveyFrame& frame : frames.Some(kFrames)) {
    const std::optional<ReadoutMeasurement> measured = frames.Localize(frame, std::nullopt).result.readout;
    if (measured) {
      readout.Add(*measured);
    }
    if (readout.images() >= kEnough) {
      break;
    }
  }
  return readout.Estimate();
}

// Ground truth and map have different frames. Some frames are localized globally; each gives a transform between the
// frames, whether or not its fix was accepted, and the transform that most others agree with is returned.
Pose2 AlignTruthToMap(const IndependentFrames& frames) {
  constexpr std::size_t kFrames = 30;
  constexpr double kAgreeM = 0.05;
  std::vector<std::pair<Pose2, Pose2>> truth_and_fix;
  for (const SurveyFrame& frame : frames.Some(kFrames)) {
    const auto truth = InterpolatePose(frames.survey.ground_truth, frame.stamp_ns);
    const LocalizedFrame fix = frames.Localize(frame, std::nullopt);
    if (truth && fix.result.inliers > 0) {
      truth_and_fix.emplace_back(*truth, fix.result.map_from_base);
    }
  }
  Pose2 best;  // identity when there is no proposal
  std::ptrdiff_t best_count = 0;
  for (const auto& proposal : truth_and_fix) {
    const Pose2 map_from_truth = proposal.second * proposal.first.Inverse();
    const auto count = std::count_if(truth_and_fix.begin(), truth_and_fix.end(), [&](const auto& pair) {
      return (map_from_truth * pair.first).Between(pair.second).translation().norm() < kAgreeM;
    });
    if (count > best_count) {
      best_count = count;
      best = map_from_truth;
    }
  }
  return best;
}

std::vector<LocalizedFrame> LocalizeIndependently(const Localizer& localizer, const Rectifier& rectifier,
                                                  const Survey& survey, const LocalizeFramesOptions& options) {
  const bool with_truth = options.prior == PriorSource::kTruth;
  if (with_truth && survey.ground_truth.empty()) {
    throw InputError(survey.folder, "has no groundtruth.tum; add it or use --prior none");
  }
  IndependentFrames independent{localizer, rectifier, survey};
  independent.readout = LearnReadout(independent);
  const Pose2 map_from_truth = with_truth ? AlignTruthToMap(independent) : Pose2();
  std::vector<LocalizedFrame> frames(survey.frames.size());
  ProgressBar progress("localize", static_cast<std::int64_t>(frames.size()), options.run.progress);
  ParallelFor(static_cast<int>(frames.size()), options.run.threads, [&](int i) {
    const SurveyFrame& frame = survey.frames[static_cast<std::size_t>(i)];
    std::optional<PosePrior> prior;
    if (const auto truth = with_truth ? InterpolatePose(survey.ground_truth, frame.stamp_ns) : std::nullopt) {
      prior = PosePrior{map_from_truth * *truth, options.prior_radius_m, options.prior_yaw_radius_rad};
    }
    frames[static_cast<std::size_t>(i)] = independent.Localize(frame, prior);
    progress.Advance();
  });
  return frames;
}

// Sequentially: the prior of a frame is the last fix propagated by odometry.
std::vector<LocalizedFrame> LocalizeWithOdometry(const Localizer& localizer, const Rectifier& rectifier,
                                                 const Survey& survey, const LocalizeFramesOptions& options) {
  if (survey.odometry.empty()) {
    throw InputError(survey.folder, "has no odometry.tum; add it or use --prior none");
  }
  std::vector<LocalizedFrame> frames;
  std::optional<Pose2> map_from_odom;
  ReadoutEstimator readout;
  ProgressBar progress("localize", static_cast<std::int64_t>(survey.frames.size()), options.run.progress);
  for (const SurveyFrame& frame : survey.frames) {
    const auto odom_from_base = InterpolatePose(survey.odometry, frame.stamp_ns);
    std::optional<PosePrior> prior;
    if (map_from_odom && odom_from_base) {
      prior = PosePrior{*map_from_odom * *odom_from_base, options.prior_radius_m, options.prior_yaw_radius_rad};
    }
    LocalizedFrame localized;
    localized.frame = frame;
    // Anywhere: lost, possibly by a kidnap.
    const FrameHints hints{.prior = prior, .motion = {TwistAt(survey.odometry, frame.stamp_ns), readout.Estimate()}};
    LocateFrame(localizer, rectifier, survey, hints, &localized);
    if (localized.result.readout) {
      readout.Add(*localized.result.readout);
    }
    if (Found(localized) && odom_from_base) {
      map_from_odom = localized.result.map_from_base * odom_from_base->Inverse();
    }
    frames.push_back(std::move(localized));
    progress.Advance();
  }
  return frames;
}

nlohmann::ordered_json ToJson(const LatticeObservation& seen) {
  const Eigen::Matrix2d& basis = seen.lattice.basis;
  const Pose2& pose = seen.map_from_base;
  return {{"basis", {{basis(0, 0), basis(1, 0)}, {basis(0, 1), basis(1, 1)}}},
          {"pose", {{"x", pose.x()}, {"y", pose.y()}, {"yaw", pose.yaw()}}},
          {"covariance", std::vector<double>(seen.covariance.data(), seen.covariance.data() + seen.covariance.size())},
          {"places", seen.CountPlaces()}};
}

}  // namespace

FrameObservation LocateFrame(const Localizer& localizer, const Rectifier& rectifier, const Survey& survey,
                             FrameHints hints, LocalizedFrame* localized) {
  const CameraModel& camera = survey.camera.camera;
  const std::filesystem::path file = survey.ImagePath(localized->frame);
  Stopwatch watch;
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(file);
  const cv::Mat raw = DecodeGray(bytes, camera.width_px, camera.height_px, file);
  localized->decode_ms = watch.LapMs();
  hints.jpeg_quality = EstimateJpegQuality(bytes);
  ObservedFrame found = ObserveAndLocalize(localizer, rectifier, raw, hints);
  localized->result = std::move(found.result);
  return std::move(found.observation);
}

cv::Mat MaskIn(const MapInfo& info, const Survey& survey) {
  return survey.mask.empty() ? MaskOfCamera(info, survey.camera) : survey.mask;
}

PriorSource ParsePriorSource(const std::string& name) {
  if (name == "none") {
    return PriorSource::kNone;
  }
  if (name == "odometry") {
    return PriorSource::kOdometry;
  }
  if (name == "truth") {
    return PriorSource::kTruth;
  }
  throw std::invalid_argument("unknown prior '" + name + "'; known are: none, odometry, truth");
}

void LocalizeFramesOptions::Check() const {
  RequireOption(prior_radius_m > 0.0, "prior_radius_m must be positive");
  RequireOption(prior_yaw_radius_rad > 0.0, "prior_yaw_radius_rad must be positive");
  run.Check();
}

std::vector<LocalizedFrame> LocalizeFrames(const Localizer& localizer, const Survey& survey,
                                           const LocalizeFramesOptions& options) {
  options.Check();
  const MapInfo& info = localizer.map().info;
  const FloorCamera camera = options.correct_camera ? CorrectedOrGiven(info, survey.camera) : survey.camera;
  const Rectifier rectifier(camera.AtResolution(info.camera().floor.resolution_m), MaskIn(info, survey));
  if (options.prior == PriorSource::kOdometry) {
    return LocalizeWithOdometry(localizer, rectifier, survey, options);
  }
  return LocalizeIndependently(localizer, rectifier, survey, options);
}

std::string ToJsonLine(const LocalizedFrame& localized) {
  const LocalizationResult& r = localized.result;
  nlohmann::ordered_json json;
  json["timestamp"] = ToSeconds(localized.frame.stamp_ns);
  json["filename"] = localized.frame.filename;
  json["status"] = ToString(r.status);
  if (r.status == LocalizationStatus::kNotLocalized) {
    json["reason"] = ToString(r.reason);
    json["x"] = json["y"] = json["yaw"] = json["covariance"] = nullptr;
  } else {
    json["x"] = r.map_from_base.x();
    json["y"] = r.map_from_base.y();
    json["yaw"] = r.map_from_base.yaw();
    json["covariance"] = std::vector<double>(r.covariance.data(), r.covariance.data() + r.covariance.size());
  }
  json["keypoints"] = r.keypoints;
  json["matches"] = r.matches;
  json["inliers"] = r.inliers;
  json["rms_m"] = r.rms_m;
  json["p_wrong"] = r.p_wrong;
  json["support_area"] = r.support_area ? nlohmann::ordered_json(*r.support_area) : nlohmann::ordered_json();
  if (r.poor_jpeg_quality) {
    json["jpeg_quality"] = *r.poor_jpeg_quality;
    if (r.status == LocalizationStatus::kNotLocalized) {
      json["warning"] = CompressedTooMuch(*r.poor_jpeg_quality);
    }
  }
  json["alternatives"] = nlohmann::ordered_json::array();
  for (const PoseHypothesis& a : r.alternatives) {
    const Pose2& pose = a.target_from_source;
    json["alternatives"].push_back(
        {{"x", pose.x()}, {"y", pose.y()}, {"yaw", pose.yaw()}, {"inliers", a.inliers}, {"weight", a.weight}});
  }
  if (r.lattice) {
    json["lattice"] = ToJson(*r.lattice);
  }
  json["search"] = r.used_prior ? "prior" : "global";
  json["timing_ms"] = {{"decode", localized.decode_ms},    {"rectify", r.timing.rectify_ms},
                       {"features", r.timing.features_ms}, {"match", r.timing.match_ms},
                       {"register", r.timing.register_ms}, {"total", localized.decode_ms + r.timing.total_ms}};
  return json.dump();
}

Trajectory ToTrajectory(const std::vector<LocalizedFrame>& frames) {
  Trajectory trajectory;
  for (const LocalizedFrame& localized : frames) {
    if (Found(localized)) {
      trajectory.push_back(StampedPose3::FromPose2(localized.frame.stamp_ns, localized.result.map_from_base));
    }
  }
  return trajectory;
}

}  // namespace floorloc
