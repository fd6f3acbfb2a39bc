// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/verdict.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/option_check.h"
#include "mapbuilder/finished_map/map_lattices.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/odometry_drift.h"
#include "mapbuilder/report/verdict_reasons.h"

namespace floorloc {
namespace {

// Thresholds beyond which a map should not be used, or only after inspection.
constexpr double kSomeFramesLost = 0.95;
constexpr double kRarelyFound = 0.75, kNotAlwaysFound = 0.95;
constexpr double kOftenWrong = 0.02;
constexpr double kFolded = 0.25;
constexpr double kLargelyWeak = 0.25;

double Share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

void AssessHeldOut(const HeldOutScore& score, VerdictReasons* reasons) {
  if (score.frames == 0) {
    reasons->Add(false,
                 "No frame was held out and localized, so it is untested whether robots can localize in "
                 "this map: too few frames, too little overlap, or held-out frames were switched off.");
    return;
  }
  const int lost = score.frames - score.localized - score.wrong - score.ambiguous;
  const double found = Share(score.localized + score.ambiguous, score.frames);
  const std::string of_all = " of " + NumberText(score.frames) + " held-out frames ";
  if (lost > 0 && found < kNotAlwaysFound) {
    reasons->Add(found < kRarelyFound, NumberText(lost) + of_all + "were not localized in a map made without them.");
  }
  if (Share(score.ambiguous, score.frames) > 1.0 - kNotAlwaysFound) {
    reasons->Add(false, NumberText(score.ambiguous) + of_all +
                            "fit at several places; where the floor repeats itself a robot needs a rough idea of where "
                            "it is (a prior).");
  }
  if (score.wrong > 0) {
    reasons->Add(found < kRarelyFound || (score.wrong > 1 && Share(score.wrong, score.frames) > kOftenWrong),
                 NumberText(score.wrong) + " of " + NumberText(score.frames) +
                     " held-out frames were localized at a wrong pose.");
  }
}

void AssessFrames(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons) {
  const auto repeated = std::count_if(build.dropped.begin(), build.dropped.end(),
                                      [](const DroppedFrame& frame) { return frame.reason == kStoodStill; });
  const int frames = build.frames - static_cast<int>(repeated);
  const double used = Share(build.frames_used, frames);
  if (frames > 0 && used < kSomeFramesLost) {
    reasons->Add(used < options.min_frames_used, NumberText(frames - build.frames_used) + " of " + NumberText(frames) +
                                                     (build.extends.empty() ? "" : " new") +
                                                     " frames are not in the map.");
  }
  const std::size_t of_masks = MaskWarnings(build).size();  // they are the first ones
  const std::vector<std::string> warnings = AllWarnings(build);
  for (std::size_t i = of_masks; i < warnings.size(); ++i) {
    reasons->Add(false, warnings[i] + (warnings[i].ends_with('.') ? "" : "."));
  }
  if (Share(build.unmatched_pairs, build.overlapping_pairs) > kFolded) {
    reasons->Add(true, "So many overlapping frames do not match that the map may be folded onto itself.");
  }
}

// True when too much of what moves with the camera is in the map.
bool AssessMasks(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons) {
  const bool severe = std::any_of(build.masks.begin(), build.masks.end(), [&](const CameraMaskFinding& mask) {
    return mask.status == CameraMaskStatus::kFound && !mask.applied && mask.share > options.max_unmasked_share;
  });
  for (const std::string& warning : MaskWarnings(build)) {
    reasons->Add(severe, warning + ".");
  }
  return severe;
}

// True when the mosaic shows what moved with a camera, and the build did not say so.
bool AssessCopies(const MapEvidence& evidence, VerdictReasons* reasons) {
  for (const CameraCopies& copies : evidence.copies) {
    const bool several = evidence.map.info.cameras.size() > 1;
    reasons->Add(true, PercentText(copies.share) + " of the view" +
                           (several ? " of survey " + std::to_string(copies.survey + 1) : "") +
                           " repeats in the mosaic at the same place of the frames: something that moves with the "
                           "camera was taken for floor; build the map again with --mask, or without --no-auto-mask.");
  }
  return !evidence.copies.empty();
}

void AssessFloor(const MapQuality& quality, VerdictReasons* reasons) {
  double bare_m2 = 0.0, missing_m2 = 0.0, self_similar_m2 = 0.0, other_m2 = 0.0;
  for (const Zone& zone : quality.zones) {
    (zone.weakness == Weakness::kFewKeypoints  ? bare_m2
     : zone.weakness == Weakness::kNotSurveyed ? missing_m2
     : zone.weakness == Weakness::kSelfSimilar ? self_similar_m2
                                               : other_m2) += zone.area_m2;
  }
  const double all_m2 = quality.surveyed_m2 + missing_m2;
  const auto part = [&](double area_m2) {
    return AreaText(area_m2) + " (" + PercentText(Share(area_m2, all_m2)) + ")";
  };
  if (bare_m2 > 0.0) {
    reasons->Add(Share(bare_m2, all_m2) > kLargelyWeak,
                 part(bare_m2) + " of the floor has too few keypoints for a robot to localize.");
  }
  if (missing_m2 > 0.0) {
    reasons->Add(
        Share(missing_m2, all_m2) > kLargelyWeak,
        part(missing_m2) + " of floor was missed: it lies between surveyed places, or its frames could not be used.");
  }
  if (self_similar_m2 > 0.0) {
    reasons->Add(false, part(self_similar_m2) +
                            " of the floor resembles other places of this map; a robot there needs a rough idea "
                            "of where it is (a prior).");
  }
  if (other_m2 > 0.0) {
    reasons->Add(false, part(other_m2) + " of the floor is weak for other reasons; the list below names them.");
  }
}

void AssessControlPoints(const BuildReport& build, const VerdictOptions& options, VerdictReasons* reasons) {
  const double rms_m = ControlPointRms(build.control_points);
  const double given_m = options.max_control_point_sigmas * ControlPointSigma(build.control_points);
  if (rms_m <= std::max(options.doubtful_control_point_m, given_m)) {
    return;
  }
  const std::string scale = FixedText(build.control_point_scale, 3);
  reasons->Add(rms_m > std::max(options.max_control_point_m, 2.0 * given_m),
               "The map misses its control points by " + LengthText(rms_m) + " RMS; " +
                   (build.control_point_scale == 1.0
                        ? "check their coordinates and pixels, or say what "
                          "they are worth (column sigma, or --control-sigma)."
                        : "they are " + scale + " times as far apart as the images say: correct the scale of " +
                              "floor.yaml, or build with --self-calibrate height."));
}

// True when odometry disagrees with the map by more than wheels do.
bool AssessDrift(const MapEvidence& evidence, const VerdictOptions& options, VerdictReasons* reasons) {
  bool doubtful = false;
  for (const OdometryDrift& drift : FollowOdometry(evidence)) {
    // Aligning at the first frame leaves a few millimetres, which count on short ways.
    const bool far = drift.largest_m > options.max_drift_share * drift.travelled_m + options.max_control_point_m;
    const bool turned = drift.largest_rad > options.max_drift_rad_per_m * std::max(1.0, drift.travelled_m);
    if (far || turned) {
      doubtful = true;
      reasons->Add(false, "Odometry and map differ by up to " + LengthText(drift.largest_m) + " and " +
                              FixedText(drift.largest_rad * 180.0 / std::numbers::pi, 0) + " degrees over " +
                              LengthText(drift.travelled_m) +
                              ", more than wheels drift: the map rests on the images alone; measure a distance in the "
                              "mosaic before you trust it.");
    }
  }
  return doubtful;
}

std::vector<std::string> Facts(const MapEvidence& evidence, const MapQuality& quality, bool drift_is_doubtful) {
  const HeldOutScore score = ScoreHeldOut(evidence.build.held_out);
  std::vector<std::string> facts;
  facts.push_back(NumberText(static_cast<int>(evidence.frames.size())) + " frames cover " +
                  AreaText(quality.surveyed_m2) + " of floor; " + NumberText(static_cast<int>(evidence.links.size())) +
                  " measured overlaps connect them.");
  if (score.frames > 0) {
    facts.push_back(NumberText(score.localized) + " of " + NumberText(score.frames) +
                    " frames that were held out were found again without any hint, " + LengthText(score.median_m) +
                    " off in the median. They share the map's poses and calibration: that is how well it agrees with "
                    "itself, not how true it is.");
  }
  if (!quality.link_strain.empty()) {
    std::vector<double> errors;
    for (const LinkStrain& strain : quality.link_strain) {
      errors.push_back(strain.error_m);
    }
    facts.push_back("Neighbouring frames agree within " + LengthText(Quantile(errors, 0.5)) +
                    " (95 %: " + LengthText(Quantile(errors, 0.95)) + ").");
  }
  if (const std::string scale = ScaleText(evidence.build.scale); !scale.empty()) {
    facts.push_back("Its scale is " + scale + ".");
  }
  for (const MapLattice& lattice : evidence.map.info.lattices) {
    facts.push_back(LatticeSentence(lattice) + ".");
  }
  if (evidence.build.drift_m > 0.0 && !drift_is_doubtful) {
    facts.push_back("Odometry had drifted by up to " + LengthText(evidence.build.drift_m) + "; that is corrected.");
  }
  return facts;
}

}  // namespace

const char* ToString(Trust trust) {
  return trust == Trust::kTrust ? "trust" : trust == Trust::kInspect ? "look_at" : "survey_again";
}

HeldOutScore ScoreHeldOut(const std::vector<HeldOutFrame>& frames) {
  HeldOutScore score;
  std::vector<double> errors_m, errors_rad;
  for (const HeldOutFrame& frame : frames) {
    ++score.frames;
    score.wrong += frame.status == "wrong" ? 1 : 0;
    score.ambiguous += frame.status == "ambiguous" ? 1 : 0;
    if (frame.status == "localized") {
      ++score.localized;
      errors_m.push_back(frame.error_m);
      errors_rad.push_back(frame.error_rad);
    }
  }
  score.median_m = Quantile(errors_m, 0.5);
  score.p95_m = Quantile(errors_m, 0.95);
  score.median_rad = Quantile(errors_rad, 0.5);
  return score;
}

double ControlPointSigma(const std::vector<ControlPointError>& points) {
  double squares = 0.0;
  for (const ControlPointError& point : points) {
    squares += point.sigma_m * point.sigma_m;
  }
  return points.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(points.size()));
}

double ControlPointRms(const std::vector<ControlPointError>& points) {
  double sum = 0.0;
  for (const ControlPointError& point : points) {
    sum += (point.observed_m - point.surveyed_m).squaredNorm();
  }
  return points.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(points.size()));
}

void VerdictOptions::Check() const {
  RequireOption(min_frames_used >= 0.0 && min_frames_used <= 1.0, "min_frames_used must be 0 to 1");
  RequireOption(doubtful_control_point_m >= 0.0, "doubtful_control_point_m must not be negative");
  RequireOption(max_control_point_m >= doubtful_control_point_m,
                "max_control_point_m must be at least doubtful_control_point_m");
  RequireOption(max_control_point_sigmas >= 0.0, "max_control_point_sigmas must not be negative");
  RequireOption(max_unmasked_share >= 0.0 && max_unmasked_share <= 1.0, "max_unmasked_share must be 0 to 1");
  RequireOption(doubtful_camera_m >= 0.0, "doubtful_camera_m must not be negative");
  RequireOption(max_camera_m >= doubtful_camera_m, "max_camera_m must be at least doubtful_camera_m");
  RequireOption(max_drift_share >= 0.0, "max_drift_share must not be negative");
  RequireOption(max_drift_rad_per_m >= 0.0, "max_drift_rad_per_m must not be negative");
}

Verdict AssessMap(const MapEvidence& evidence, const MapQuality& quality, const VerdictOptions& options) {
  options.Check();
  const HeldOutScore score = ScoreHeldOut(evidence.build.held_out);
  VerdictReasons reasons;
  AssessHeldOut(score, &reasons);
  const bool told = AssessMasks(evidence.build, options, &reasons);
  const bool lacks_mask = told || AssessCopies(evidence, &reasons);
  const std::size_t for_masks = reasons.severe.size();
  const bool bent = AssessCameras(evidence.build, options, &reasons);
  const std::size_t for_cameras = reasons.severe.size();
  const bool repeats = AssessRepetition(evidence.build, options, &reasons);
  AssessFrames(evidence.build, options, &reasons);
  AssessFloor(quality, &reasons);
  AssessControlPoints(evidence.build, options, &reasons);
  Verdict verdict;
  verdict.facts = Facts(evidence, quality, AssessDrift(evidence, options, &reasons));
  verdict.reasons = reasons.severe;
  verdict.reasons.insert(verdict.reasons.end(), reasons.mild.begin(), reasons.mild.end());
  if (!reasons.severe.empty()) {
    verdict.trust = Trust::kResurvey;
    const bool mask_alone = lacks_mask && reasons.severe.size() == for_masks;
    const bool camera_alone = bent && reasons.severe.size() == for_cameras;
    verdict.headline =
        std::string("Do not use this map yet: ") + (mask_alone     ? "build it again with a mask"
                                                    : camera_alone ? "build it again with self-calibration"
                                                    : repeats      ? "survey again with odometry"
                                                                   : "survey again");
  } else if (!reasons.mild.empty()) {
    verdict.trust = Trust::kInspect;
    verdict.headline = quality.zones.empty()       ? "You can trust this map, but read the warnings below"
                       : quality.zones.size() == 1 ? "You can trust this map, but check one place"
                                                   : "You can trust this map, but check " +
                                                         NumberText(static_cast<int>(quality.zones.size())) + " places";
  } else {
    verdict.headline = "You can trust this map";
  }
  return verdict;
}

}  // namespace floorloc
