// SPDX-License-Identifier: Apache-2.0
#include "core/localization/moving_frame.h"

#include <cmath>
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

bool IsLocalized(const ObservedFrame& frame) { return frame.result.status == LocalizationStatus::kLocalized; }

// A large view is looked at in part first; not where parts of it are left out, which the part could consist of.
ObservedFrame Localize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                       const FrameHints& hints) {
  const ReadoutMotion motion = MotionOf(rectifier.camera().camera.readout, hints.motion, localizer.options().readout);
  LocalizationTiming of_part;
  if (hints.left_out.empty()) {
    if (std::optional<FrameObservation> part = localizer.ObservePart(rectifier, raw, motion)) {
      part->SetContext(hints.camera, hints.jpeg_quality);
      LocalizationResult result = localizer.Localize(*part, hints.prior);
      if (result.status == LocalizationStatus::kLocalized) {
        return {*std::move(part), std::move(result)};
      }
      of_part = result.timing;
    }
  }
  FrameObservation whole = localizer.Observe(rectifier, raw, motion, hints.left_out);
  whole.SetContext(hints.camera, hints.jpeg_quality);
  LocalizationResult result = hints.anywhere ? localizer.LocalizeWithGlobalFallback(whole, hints.prior)
                                             : localizer.Localize(whole, hints.prior);
  result.timing += of_part;
  return {std::move(whole), std::move(result)};
}

// At speed nothing matches an image whose rows are far from where they belong: likely read-outs are tried. Each finds
// images whose read-out is within 12 ms of it at 1 m/s (`./run bench calibration --case readout`). hints: gets the
// read-out with which the frame is localized.
void TryLikelyReadouts(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw, FrameHints* hints,
                       ObservedFrame* frame) {
  constexpr double kLikelyShare = 0.7;  // of the assumed one: 23 ms
  constexpr double kMinMotionM = 0.01;
  const double assumed_s = localizer.options().readout.assumed_s;
  if (IsLocalized(*frame) || hints->motion.learnt || assumed_s * hints->motion.twist->head<2>().norm() < kMinMotionM) {
    return;
  }
  for (const double seconds : {kLikelyShare * assumed_s, -kLikelyShare * assumed_s}) {
    FrameHints likely = *hints;
    likely.motion.learnt = ReadoutMeasurement{seconds, 0.5 * assumed_s};
    ObservedFrame found = Localize(localizer, rectifier, raw, likely);
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
  return !motion.learnt || options.readout.residual_share * motion.learnt->sigma_s * motion.twist->head<2>().norm() >
                               options.readout_fit.max_error_m;
}

std::optional<PosePrior> Near(const LocalizationResult& result, const std::optional<PosePrior>& prior) {
  if (result.status == LocalizationStatus::kLocalized) {
    return PosePrior{result.map_from_base, kNearM, kNearRad};
  }
  return prior;
}

// Measures the read-out of a localized frame and localizes it again. Exact from a frame that was rectified as if at
// rest; from another one the rows are about 8 % of the correction off, so it is repeated. hints: of the frame.
void Refine(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw, FrameHints hints,
            ObservedFrame* frame) {
  constexpr int kMaxPasses = 3;
  constexpr double kConvergedS = 1e-3;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::optional<PosePrior> near = Near(frame->result, hints.prior);
    auto measured = near
                        ? localizer.MeasureReadout(frame->observation, rectifier.camera(), {*near, *hints.motion.twist})
                        : std::nullopt;
    if (!measured) {
      return;
    }
    const bool exact = !hints.motion.learnt || std::abs(measured->seconds) < kConvergedS;
    measured->seconds += hints.motion.learnt ? hints.motion.learnt->seconds : 0.0;
    hints.motion.learnt = measured;
    ObservedFrame again = Localize(localizer, rectifier, raw, hints);
    if (!IsLocalized(again)) {
      return;
    }
    again.result.timing.total_ms += frame->result.timing.total_ms;
    again.result.readout = measured;
    *frame = std::move(again);
    if (exact) {
      return;
    }
  }
}

}  // namespace

ObservedFrame ObserveAndLocalize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                                 const FrameHints& hints) {
  ObservedFrame frame = Localize(localizer, rectifier, raw, hints);
  if (MustMeasure(rectifier.camera().camera.readout, hints.motion, localizer.options())) {
    FrameHints better = hints;
    TryLikelyReadouts(localizer, rectifier, raw, &better, &frame);
    Refine(localizer, rectifier, raw, better, &frame);
  }
  return frame;
}

}  // namespace floorloc
