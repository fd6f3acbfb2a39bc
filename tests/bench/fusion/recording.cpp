// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/recording.h"

#include <algorithm>
#include <cmath>

#include "core/evaluation/alignment.h"
#include "core/io/delimited_text.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "core/map/camera_correction.h"
#include "core/odometry/planar_odometry.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// Motion between two times by wheel odometry, the initial guess of visual odometry.
std::optional<Pose2> WheelsBetween(const Trajectory& odometry, std::int64_t from_ns, std::int64_t to_ns) {
  const std::optional<Pose2> from = InterpolatePose(odometry, from_ns);
  const std::optional<Pose2> to = InterpolatePose(odometry, to_ns);
  return from && to ? std::optional(from->Between(*to)) : std::nullopt;
}

std::vector<RecordedImage> LocalizeImages(const Localizer& localizer, const Survey& survey) {
  const MapInfo& info = localizer.map().info;
  const Rectifier rectifier(CorrectedOrGiven(info, survey.camera).AtResolution(info.camera().floor.resolution_m),
                            survey.mask);
  PlanarOdometryOptions options;
  options.resolution_m = localizer.map().info.camera().floor.resolution_m;
  PlanarOdometry visual(options);
  std::vector<RecordedImage> images;
  const CameraModel& camera = survey.camera.camera;
  for (const SurveyFrame& frame : survey.frames) {
    const cv::Mat raw = ReadGrayImage(survey.ImagePath(frame), camera.width_px, camera.height_px);
    const FrameObservation observation = localizer.Observe(rectifier, raw);
    const LocalizationResult found = localizer.Localize(observation, std::nullopt);
    RecordedImage image{frame.stamp_ns, std::nullopt, std::nullopt};
    if (found.status == LocalizationStatus::kLocalized) {
      image.fix = PoseFix{frame.stamp_ns, found.map_from_base, found.covariance, found.p_wrong};
    }
    const auto guess =
        images.empty() ? std::nullopt : WheelsBetween(survey.odometry, images.back().stamp_ns, frame.stamp_ns);
    if (const auto motion = visual.Track(frame.stamp_ns, observation.features, guess).motion) {
      image.motion = MotionIncrement{motion->from_ns, motion->to_ns, motion->from_from_to, motion->covariance};
    }
    images.push_back(image);
  }
  return images;
}

std::vector<std::int64_t> ReadKidnaps(const fs::path& events) {
  std::vector<std::int64_t> kidnaps_ns;
  if (!fs::exists(events)) {
    return kidnaps_ns;
  }
  const std::string text = ReadTextFile(events);
  for (const TextLine& line : ContentLines(text)) {
    const std::vector<std::string_view> fields = SplitFields(line.text, ',');
    if (fields.size() == 3 && fields[2] == "kidnap") {
      const auto stamp_ns = ParseSeconds(std::string(fields[0]));
      if (!stamp_ns) {
        throw InputError(events, line.number, "the time stamp is not a number of seconds; correct the row");
      }
      kidnaps_ns.push_back(*stamp_ns);
    }
  }
  return kidnaps_ns;
}

// Least squares, repeated over the better half, so that it is robust to wrong fixes.
Pose2 MapFromTruth(const std::vector<RecordedImage>& images, const Trajectory& truth, const fs::path& drive) {
  std::vector<PosePair> pairs;
  for (const RecordedImage& image : images) {
    if (const auto pose = InterpolatePose(truth, image.stamp_ns); pose && image.fix) {
      pairs.push_back({StampedPose3::FromPose2(image.stamp_ns, image.fix->map_from_base),
                       StampedPose3::FromPose2(image.stamp_ns, *pose)});
    }
  }
  if (pairs.size() < 10) {
    throw InputError(drive, "has fewer than ten localized frames; give a drive on the map");
  }
  std::vector<PosePair> kept = pairs;
  Similarity3 motion;
  for (int i = 0; i < 3; ++i) {
    motion = ComputeAlignment(kept, AlignmentMode::kSe2);
    const auto error = [&motion](const PosePair& pair) {
      return ((motion * pair.estimate).translation_m - pair.reference.translation_m).norm();
    };
    std::sort(pairs.begin(), pairs.end(),
              [&error](const PosePair& a, const PosePair& b) { return error(a) < error(b); });
    kept.assign(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2));
  }
  return (motion * StampedPose3{}).ToPose2();
}

}  // namespace

FusionRecording ReadFusionRecording(const Localizer& localizer, const fs::path& drive) {
  const Survey survey = ReadSurvey(drive);
  FusionRecording recording;
  recording.name = drive.filename().string();
  recording.odometry = survey.odometry;
  for (const ImuSample& sample : survey.imu) {
    recording.imu.push_back({sample.stamp_ns, sample.angular_velocity.z(), sample.acceleration.head<2>()});
  }
  recording.images = LocalizeImages(localizer, survey);
  recording.kidnaps_ns = ReadKidnaps(drive / "events.csv");
  const Trajectory truth = ReadTum(drive / "groundtruth_dense.tum");
  const Pose2 map_from_truth = MapFromTruth(recording.images, survey.ground_truth, drive);
  for (const StampedPose3& pose : truth) {
    recording.truth.push_back(StampedPose3::FromPose2(pose.stamp_ns, map_from_truth * pose.ToPose2()));
  }
  if (recording.truth.size() != recording.odometry.size()) {
    throw InputError(drive, "must have one row of groundtruth_dense.tum per row of odometry.tum; simulate it anew");
  }
  return recording;
}

}  // namespace floorloc
