// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/report/quality.h"

namespace floorloc {

enum class Trust { kTrust, kInspect, kResurvey };
/// "trust", "look_at", "survey_again"
const char* ToString(Trust trust);

struct VerdictOptions {
  /// A map that holds a smaller share of the survey's frames is not to be used; frames taken at standstill count as
  /// held. Users of exit code 3 rely on it: docs/survey.md.
  double min_frames_used = 0.8;
  /// RMS misfit of the control points. From the first on it is to be inspected, from the second on the map is not to be
  /// used. 8 exact ones read to 0.5 px leave 0.5 mm on a floor of 2.6 x 1.8 m, with 5 mm of noise 7 mm, with 20 mm 31
  /// mm.
  double doubtful_control_point_m = 0.005;
  double max_control_point_m = 0.02;
  /// Neither is below what the points are worth: their misfit is larger than this many of their standard deviations, or
  /// twice as many, in less than 5 % of all surveys with four points or more (chi-square).
  double max_control_point_sigmas = 2.0;
  /// A map is not to be used when more of a survey's images than this moves with the camera and was not masked: a part
  /// over 13 % made 49 of 100 hard frames of a concrete floor go wrong.
  double max_unmasked_share = 0.02;
  /// Drift of odometry over the distance travelled beyond which it is no evidence for the map but a doubt. Wheels that
  /// nobody calibrated err by 2 % and less than a degree per metre on UMBmark's 16 m (Borenstein & Feng 1996).
  double max_drift_share = 0.04;
  double max_drift_rad_per_m = 0.0175;
  /// RMS by which the images would move the poses of a map whose cameras were not calibrated by them; from the first on
  /// it is to be inspected, from the second on it is not to be used. On 3 x 2 m from 0.4 m, surveyed at two headings or
  /// at all: 0.16 mm with exact cameras, 0.8 mm with the usual error (0.3 px, 0.1 degrees), 1.8 mm with 0.5 px, 0.2
  /// degrees and 1 mm of height; calibrated by their images at most 0.15 mm.
  double doubtful_camera_m = 0.0005;
  double max_camera_m = 0.001;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Summary of the report.
struct Verdict {
  Trust trust = Trust::kTrust;
  std::string headline;
  std::vector<std::string> reasons;  ///< one sentence each; problems
  std::vector<std::string> facts;    ///< one sentence each; evidence in favour

  bool Usable() const { return trust != Trust::kResurvey; }
};

/// Counts and errors of held-out frames.
struct HeldOutScore {
  int frames = 0;
  int localized = 0;  ///< correctly
  int wrong = 0;
  int ambiguous = 0;
  double median_m = 0.0;  ///< of the localized ones
  double p95_m = 0.0;
  double median_rad = 0.0;
};
HeldOutScore ScoreHeldOut(const std::vector<HeldOutFrame>& frames);

/// RMS error in metres; 0 without points.
double ControlPointRms(const std::vector<ControlPointError>& points);
/// RMS of the standard deviations of their coordinates, as given; 0: there are none.
double ControlPointSigma(const std::vector<ControlPointError>& points);

Verdict AssessMap(const MapEvidence& evidence, const MapQuality& quality, const VerdictOptions& options = {});

}  // namespace floorloc
