// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localization_result.h"

namespace floorloc {

const char* ToString(LocalizationStatus status) {
  switch (status) {
    case LocalizationStatus::kLocalized:
      return "localized";
    case LocalizationStatus::kAmbiguous:
      return "ambiguous";
    case LocalizationStatus::kNotLocalized:
      return "not_localized";
  }
  return "unknown";
}

const char* ToString(NotLocalizedReason reason) {
  switch (reason) {
    case NotLocalizedReason::kNone:
      return "";
    case NotLocalizedReason::kTooFewKeypoints:
      return "too_few_keypoints";
    case NotLocalizedReason::kTooFewMatches:
      return "too_few_matches";
    case NotLocalizedReason::kTooFewInliers:
      return "too_few_inliers";
    case NotLocalizedReason::kNotSignificant:
      return "not_significant";
    case NotLocalizedReason::kContradictsPrior:
      return "contradicts_prior";
    case NotLocalizedReason::kViewDisagrees:
      return "view_disagrees";
    case NotLocalizedReason::kNoFloor:
      return "no_floor";
    case NotLocalizedReason::kOtherFloor:
      return "other_floor";
  }
  return "unknown";
}

}  // namespace floorloc
