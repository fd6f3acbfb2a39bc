// SPDX-License-Identifier: Apache-2.0
#include "core/localization/moving_frame.h"

#include <utility>

namespace floorloc {
namespace {

// How far the pose of an image whose rows are not where they belong may be off: the motion of the longest read-out.
constexpr double kNearM = 0.06;
constexpr double kNearRad = 0.12;

// The learnt read-out stands in for the one that the camera does not tell.
ReadoutMotion MotionOf(const Readout& readout, const FrameMotion& motion, const ReadoutOptions& options) {
  if (readout.seconds || !motion.learnt || !motion.twist) {
    return MotionOfReadout(readout, motion.twist, options);
  }
  const Eigen::Vector3d error = options.residual_share * motion.learnt->sigma_s * *motion.twist;
  return {motion.learnt->seconds * *motion.twist, error * error.transpose()};
}

ObservedFrame Localize(const Localizer& localizer, const FrameHints& hints, FrameObservation observation) {
  observation.samples.SetCameraPrior(hints.camera);
  LocalizationResult result = hints.anywhere ? localizer.LocalizeWithGlobalFallback(observation, hints.prior)
                                             : localizer.Localize(observation, hints.prior);
  return {std::move(observation), std::move(result)};
}

// True while this image's read-out is not known well enough for its speed.
bool MustMeasure(const Readout& readout, const FrameMotion& motion, const LocalizerOptions& options) {
  if (readout.seconds || !motion.twist) {
    return false;
  }
  return !motion.learnt || options.readout.residual_share * motion.learnt->sigma_s * motion.twist->head<2>().norm() >
                               options.readout_fit.max_error_m;
}

std::optional<PosePrior> Near(const LocalizationResult& result, const std::optional<PosePrior>& prior) {
  if (result.status == LocalizationStatus::kLocalized) {
    return PosePrior{result.map_from_base, kNearM, kNearRad};
  }
  return prior;
}

}  // namespace

ObservedFrame ObserveAndLocalize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                                 const FrameHints& hints) {
  const Readout& readout = rectifier.camera().camera.readout;
  const ReadoutOptions& options = localizer.options().readout;
  ObservedFrame frame =
      Localize(localizer, hints, localizer.Observe(rectifier, raw, MotionOf(readout, hints.motion, options)));
  const std::optional<PosePrior> near = Near(frame.result, hints.prior);
  if (!near || !MustMeasure(readout, hints.motion, localizer.options())) {
    return frame;
  }
  auto measured = localizer.MeasureReadout(frame.observation, rectifier.camera(), {*near, *hints.motion.twist});
  if (!measured) {
    return frame;
  }
  measured->seconds += hints.motion.learnt ? hints.motion.learnt->seconds : 0.0;
  FrameMotion motion = hints.motion;
  motion.learnt = measured;
  const LocalizationTiming before = frame.result.timing;
  ObservedFrame again =
      Localize(localizer, hints, localizer.Observe(rectifier, raw, MotionOf(readout, motion, options)));
  if (again.result.status == LocalizationStatus::kLocalized) {
    frame = std::move(again);
    frame.result.timing.total_ms += before.total_ms;
    frame.result.readout = measured;
  }
  return frame;
}

}  // namespace floorloc
