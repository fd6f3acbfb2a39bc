// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/adaptive_drive.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/laboratory/image_features.h"

namespace floorloc {
namespace {

// An image of a drive at the size that is evaluated.
struct SmallImage {
  GroundGrid grid;
  cv::Mat gray;
  cv::Mat mask;
};

SmallImage ReadSmall(const Survey& survey, const SurveyFrame& frame, const Rectifier& rectifier, int width_px) {
  const CameraModel& camera = survey.camera.camera;
  const GroundImage image =
      rectifier.Rectify(ReadGrayImage(survey.ImagePath(frame), camera.width_px, camera.height_px));
  SmallImage small{image.grid, image.gray, image.mask};
  if (small.gray.cols > width_px) {
    const double factor = static_cast<double>(width_px) / small.gray.cols;
    const cv::Size size(width_px, cvRound(factor * small.gray.rows));
    cv::resize(image.gray, small.gray, size, 0, 0, cv::INTER_AREA);
    cv::resize(image.mask, small.mask, size, 0, 0, cv::INTER_NEAREST);
    // The corner of the top left pixel stays where it is.
    small.grid.resolution_m /= factor;
    small.grid.x_top_m += 0.5 * (image.grid.resolution_m - small.grid.resolution_m);
    small.grid.y_left_m += 0.5 * (image.grid.resolution_m - small.grid.resolution_m);
    small.grid.width_px = size.width;
    small.grid.height_px = size.height;
  }
  return small;
}

// Pixels run against the axes of the base frame: turns change their sign.
Pose2 BaseMotion(const Pose2& second_from_first_px, const GroundGrid& grid) {
  const double r = grid.resolution_m;
  const Eigen::Vector2d origin = grid.BaseFromPixel(0.0, 0.0);
  const Eigen::Vector2d t = second_from_first_px.translation();
  const Pose2 turn(0.0, 0.0, -second_from_first_px.yaw());
  const Eigen::Vector2d moved = Eigen::Vector2d(-r * t.y(), -r * t.x()) + origin - turn * origin;
  return {moved.x(), moved.y(), turn.yaw()};
}

// The fastest of some repetitions.
template <typename Work>
double TimeMilliseconds(int repetitions, const Work& work) {
  double best_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const double start_ms = ThreadMilliseconds();
    work();
    best_ms = std::min(best_ms, ThreadMilliseconds() - start_ms);
  }
  return best_ms;
}

// Detects in an image and compares it with the one before.
class DetectorRun {
 public:
  DetectorRun(DetectFunction detect, const AdaptiveDriveOptions& options)
      : detect_(std::move(detect)), options_(options) {}

  std::optional<DetectionScore> Add(const SmallImage& image, const cv::Mat& mask, const Pose2& before_from_now) {
    if (!detect_) {
      return std::nullopt;
    }
    DetectionScore score;
    std::vector<cv::KeyPoint> keypoints;
    score.detect_ms = TimeMilliseconds(options_.repetitions, [&] { keypoints = detect_(image.gray, mask); });
    score.keypoints = static_cast<int>(keypoints.size());
    PatchedImage now = CutPatches(image.gray, keypoints, options_.tracker);
    const std::vector<PatchMatch> matches = MatchPatches(before_, now, options_.tracker);
    for (const PatchMatch& match : matches) {
      score.correct += IsCorrect(match, now, image.grid, before_from_now) ? 1 : 0;
    }
    const PatchMotion motion = EstimatePatchMotion(before_, now, matches, options_.tracker);
    score.inliers = static_cast<int>(motion.inliers.size());
    score.before_from_now = BaseMotion(motion.second_from_first, image.grid).Inverse();
    before_ = std::move(now);
    return score;
  }

 private:
  bool IsCorrect(const PatchMatch& match, const PatchedImage& now, const GroundGrid& grid,
                 const Pose2& before_from_now) const {
    const cv::Point2f& a = before_.points[static_cast<std::size_t>(match.first)];
    const cv::Point2f& b = now.points[static_cast<std::size_t>(match.second)];
    const Eigen::Vector2d expected = grid.PixelFromBase(before_from_now * grid.BaseFromPixel(b.x, b.y));
    return (expected - Eigen::Vector2d(a.x, a.y)).norm() <= options_.correct_px;
  }

  DetectFunction detect_;
  const AdaptiveDriveOptions& options_;
  PatchedImage before_;
};

}  // namespace

void AdaptiveDriveOptions::Check() const {
  RequireOption(width_px >= 64, "width_px must be at least 64");
  RequireOption(correct_px > 0.0, "correct_px must be positive");
  RequireOption(repetitions >= 1, "repetitions must be at least 1");
  detectors.Check();
  tracker.Check();
}

std::vector<AdaptiveFrame> MeasureAdaptiveDrive(const std::filesystem::path& drive, const TextureClassifier& classifier,
                                                const AdaptiveDriveOptions& options) {
  options.Check();
  const Survey survey = ReadSurvey(drive);
  if (survey.ground_truth.empty()) {
    throw InputError(drive, "has no groundtruth.tum; without it no match is known to be correct");
  }
  const Rectifier rectifier(survey.camera, survey.mask);
  std::vector<DetectorRun> runs;
  for (const ArticleDetector detector : kArticleDetectors) {
    runs.emplace_back(MakeArticleDetector(detector, options.detectors), options);
  }
  ProgressBar progress("detectors", static_cast<std::int64_t>(survey.frames.size()), options.progress);
  std::vector<AdaptiveFrame> frames;
  for (const SurveyFrame& survey_frame : survey.frames) {
    progress.Advance();
    const std::optional<Pose2> truth = InterpolatePose(survey.ground_truth, survey_frame.stamp_ns);
    if (!truth) {
      continue;
    }
    const SmallImage image = ReadSmall(survey, survey_frame, rectifier, options.width_px);
    AdaptiveFrame frame;
    frame.map_from_base = *truth;
    TextureAssessment assessment;
    frame.assess_ms =
        TimeMilliseconds(options.repetitions, [&] { assessment = AssessTexture(image.gray, classifier); });
    frame.texture = assessment.texture;
    const cv::Mat mask = options.mask_shadow ? image.mask & assessment.WithoutShadow(image.gray.size()) : image.mask;
    const Pose2 before_from_now = frames.empty() ? Pose2() : frames.back().map_from_base.Between(frame.map_from_base);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      frame.detectors[i] = runs[i].Add(image, mask, before_from_now);
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace floorloc
