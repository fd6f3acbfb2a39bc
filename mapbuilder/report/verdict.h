// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/report/quality.h"

namespace floorloc {

enum class Trust { kTrust, kInspect, kResurvey };
/// "trust", "look_at", "survey_again"
const char* ToString(Trust trust);

/// What a report says first.
struct Verdict {
  Trust trust = Trust::kTrust;
  std::string headline;
  std::vector<std::string> reasons;  ///< sentences; why it is not better
  std::vector<std::string> facts;    ///< sentences; what supports it
};

/// Held-out frames by outcome.
struct HeldOutScore {
  int frames = 0;
  int localized = 0;  ///< and right
  int wrong = 0;
  int ambiguous = 0;
  double median_m = 0.0;  ///< of the localized ones
  double p95_m = 0.0;
  double median_rad = 0.0;
};
HeldOutScore ScoreHeldOut(const std::vector<HeldOutFrame>& frames);

/// Metres; 0 without points.
double ControlPointRms(const std::vector<ControlPointError>& points);

Verdict AssessMap(const MapEvidence& evidence, const MapQuality& quality);

}  // namespace floorloc
