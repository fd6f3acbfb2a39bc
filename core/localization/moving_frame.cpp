// SPDX-License-Identifier: Apache-2.0
#include "core/localization/moving_frame.h"

#include <cmath>
#include <utility>

#include "core/localization/stopwatch.h"

namespace floorloc {
namespace {

// How far the pose of an image whose rows are not where they belong may be off: the motion of the longest read-out.
constexpr double kNearM = 0.06;
constexpr double kNearRad = 0.12;

// What an error of the read-out does to the pose (x, y, yaw) of a moving base.
Eigen::Vector3d PoseError(double seconds, const Eigen::Vector3d& twist, const ReadoutOptions& options) {
  return options.residual_share * seconds * twist;
}

// The learnt read-out stands in for the one that the camera does not tell.
ReadoutMotion MotionOf(const Readout& readout, const FrameMotion& motion, const ReadoutOptions& options) {
  if (readout.seconds || !motion.learnt || !motion.twist) {
    return MotionOfReadout(readout, motion.twist, options);
  }
  const Eigen::Vector3d error = PoseError(motion.learnt->sigma_s, *motion.twist, options);
  return {motion.learnt->seconds * *motion.twist, error * error.transpose()};
}

// A frame whose rows may still be elsewhere than where they belong. covariance: of the pose, by that, base frame.
struct Sheared {
  ObservedFrame frame;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

bool IsLocalized(const Sheared& sheared) { return sheared.frame.result.status == LocalizationStatus::kLocalized; }

LocalizationResult Seek(const Localizer& localizer, const FrameObservation& frame, const FrameHints& hints) {
  return hints.anywhere ? localizer.LocalizeWithGlobalFallback(frame, hints.prior)
                        : localizer.Localize(frame, hints.prior);
}

// A frame that is not localized, or by few keypoints, is sought once more with its motion's blur undone, where some is
// seen.
ObservedFrame SeekBlurred(const Localizer& localizer, FrameObservation frame, const FrameHints& hints) {
  LocalizationResult result = Seek(localizer, frame, hints);
  const bool localized = result.status == LocalizationStatus::kLocalized;
  const bool sure = localized && result.inliers >= localizer.options().photometric.sure_inliers;
  if (sure || !hints.motion.twist) {
    return {std::move(frame), std::move(result)};
  }
  Stopwatch watch;
  std::optional<FrameObservation> deblurred = localizer.Deblur(frame, *hints.motion.twist, hints.left_out);
  if (!deblurred) {
    const double in_vain_ms = watch.LapMs();
    result.timing += {.features_ms = in_vain_ms, .total_ms = in_vain_ms};
    return {std::move(frame), std::move(result)};
  }
  LocalizationResult again = Seek(localizer, *deblurred, hints);
  if (again.status == LocalizationStatus::kLocalized && (!localized || again.inliers > result.inliers)) {
    again.timing += result.timing;
    return {*std::move(deblurred), std::move(again)};
  }
  result.timing += again.timing;
  return {std::move(frame), std::move(result)};
}

// A large view is looked at in part first; not where parts of it are left out, which the part could consist of.
Sheared Localize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw, const FrameHints& hints) {
  const ReadoutMotion motion = MotionOf(rectifier.camera().camera.readout, hints.motion, localizer.options().readout);
  LocalizationTiming of_part;
  if (hints.left_out.empty()) {
    if (std::optional<FrameObservation> part = localizer.ObservePart(rectifier, raw, motion.motion)) {
      part->SetContext(hints.camera, hints.jpeg_quality);
      LocalizationResult result = localizer.Localize(*part, hints.prior);
      if (result.status == LocalizationStatus::kLocalized) {
        return {{*std::move(part), std::move(result)}, motion.covariance};
      }
      of_part = result.timing;
    }
  }
  FrameObservation whole = localizer.Observe(rectifier, raw, motion.motion, hints.left_out);
  whole.SetContext(hints.camera, hints.jpeg_quality);
  ObservedFrame frame = SeekBlurred(localizer, std::move(whole), hints);
  frame.result.timing += of_part;
  return {std::move(frame), motion.covariance};
}

// At speed nothing matches an image whose rows are far from where they belong: likely read-outs are tried. Each finds
// images whose read-out is within 12 ms of it at 1 m/s (`./run bench calibration --case readout`). hints: gets the
// read-out with which the frame is localized.
void TryLikelyReadouts(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw, FrameHints* hints,
                       Sheared* frame) {
  constexpr double kLikelyShare = 0.7;  // of the assumed one: 23 ms
  constexpr double kMinMotionM = 0.01;
  const double assumed_s = localizer.options().readout.assumed_s;
  if (IsLocalized(*frame) || hints->motion.learnt || assumed_s * hints->motion.twist->head<2>().norm() < kMinMotionM) {
    return;
  }
  for (const double seconds : {kLikelyShare * assumed_s, -kLikelyShare * assumed_s}) {
    FrameHints likely = *hints;
    likely.motion.learnt = ReadoutMeasurement{seconds, 0.5 * assumed_s};
    Sheared found = Localize(localizer, rectifier, raw, likely);
    if (IsLocalized(found)) {
      *frame = std::move(found);
      *hints = likely;
      return;
    }
  }
}

// True while this image's read-out is not known well enough for its speed.
bool MustMeasure(const Readout& readout, const FrameMotion& motion, const LocalizerOptions& options) {
  if (readout.seconds || !motion.twist) {
    return false;
  }
  return !motion.learnt || PoseError(motion.learnt->sigma_s, *motion.twist, options.readout).head<2>().norm() >
                               options.readout_fit.max_error_m;
}

// True where rectifying the image with what was measured (relative to how it was rectified) would not help.
bool IsNegligible(const ReadoutMeasurement& measured, const Eigen::Vector3d& twist, const LocalizerOptions& options) {
  const double error_m = PoseError(measured.seconds, twist, options.readout).head<2>().norm();
  return error_m <= options.readout_fit.max_error_m || std::abs(measured.seconds) <= measured.sigma_s;
}

std::optional<PosePrior> Near(const LocalizationResult& result, const std::optional<PosePrior>& prior) {
  if (result.status == LocalizationStatus::kLocalized) {
    return PosePrior{result.map_from_base, kNearM, kNearRad};
  }
  return prior;
}

// Measures the read-out of a frame and, where that matters, localizes it again. Exact from a frame that was rectified
// as if at rest; from another one the rows are about 8 % of the correction off, so it is repeated. hints: of the frame.
void Refine(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw, FrameHints hints,
            Sheared* sheared) {
  constexpr int kMaxPasses = 3;
  const Eigen::Vector3d& twist = *hints.motion.twist;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    LocalizationResult& result = sheared->frame.result;
    const std::optional<PosePrior> near = Near(result, hints.prior);
    const auto by =
        near ? localizer.MeasureReadout(sheared->frame.observation, rectifier.camera(), {*near, twist}) : std::nullopt;
    if (!by) {
      return;
    }
    const bool exact = !hints.motion.learnt;
    const ReadoutMeasurement measured{by->seconds + (exact ? 0.0 : hints.motion.learnt->seconds), by->sigma_s};
    if (IsLocalized(*sheared) && IsNegligible(*by, twist, localizer.options())) {
      const Eigen::Vector3d error = PoseError(std::hypot(by->seconds, by->sigma_s), twist, localizer.options().readout);
      sheared->covariance = error * error.transpose();
      result.readout = measured;
      return;
    }
    hints.motion.learnt = measured;
    Sheared again = Localize(localizer, rectifier, raw, hints);
    if (!IsLocalized(again)) {
      return;
    }
    again.frame.result.timing.total_ms += result.timing.total_ms;
    again.frame.result.readout = measured;
    *sheared = std::move(again);
    if (exact) {
      return;
    }
  }
}

// What a read-out shears looks like errors of the camera, which are not to be learnt from it.
void AddReadout(const Eigen::Matrix3d& covariance_in_base, const ReadoutFitOptions& options,
                LocalizationResult* result) {
  if (result->covariance.isZero() || covariance_in_base.isZero()) {
    return;
  }
  Eigen::Matrix3d map_from_base = Eigen::Matrix3d::Identity();
  map_from_base.topLeftCorner<2, 2>() = result->map_from_base.rotation();
  result->covariance += map_from_base * covariance_in_base * map_from_base.transpose();
  if (covariance_in_base.topLeftCorner<2, 2>().trace() > options.max_error_m * options.max_error_m) {
    result->camera.reset();
  }
}

}  // namespace

ObservedFrame ObserveAndLocalize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                                 const FrameHints& hints) {
  Sheared sheared = Localize(localizer, rectifier, raw, hints);
  if (MustMeasure(rectifier.camera().camera.readout, hints.motion, localizer.options())) {
    FrameHints better = hints;
    TryLikelyReadouts(localizer, rectifier, raw, &better, &sheared);
    Refine(localizer, rectifier, raw, better, &sheared);
  }
  AddReadout(sheared.covariance, localizer.options().readout_fit, &sheared.frame.result);
  return std::move(sheared.frame);
}

}  // namespace floorloc
