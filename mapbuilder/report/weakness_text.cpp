// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/weakness_text.h"

#include <cmath>

#include "mapbuilder/report/number_text.h"

namespace floorloc {

const char* Name(Weakness weakness) {
  switch (weakness) {
    case Weakness::kNotSurveyed:
      return "missing from the map";
    case Weakness::kFewKeypoints:
      return "too few keypoints";
    case Weakness::kObservedOnce:
      return "seen by one frame only";
    case Weakness::kSelfSimilar:
      return "resembles other places";
    case Weakness::kStrained:
      return "frames disagree";
    case Weakness::kNotFound:
      return "held-out frame not found";
    case Weakness::kNone:
      break;
  }
  return "";
}

const char* Key(Weakness weakness) {
  switch (weakness) {
    case Weakness::kNotSurveyed:
      return "not_surveyed";
    case Weakness::kFewKeypoints:
      return "few_keypoints";
    case Weakness::kObservedOnce:
      return "seen_once";
    case Weakness::kSelfSimilar:
      return "self_similar";
    case Weakness::kStrained:
      return "strained";
    case Weakness::kNotFound:
      return "not_found";
    case Weakness::kNone:
      break;
  }
  return "none";
}

const char* Advice(const Zone& zone) {
  switch (zone.weakness) {
    case Weakness::kNotSurveyed:
      return zone.lost_frames > 0
                 ? "Drive over it again, slowly and in good light, with overlap to the floor around it."
                 : "Drive over it, if the robots go there; ignore it if something is placed there.";
    case Weakness::kFewKeypoints:
      return "Survey it slowly and in good light. If the floor is plain there, robots must cross it by odometry, or "
             "need a marker.";
    case Weakness::kObservedOnce:
      return "Drive over it once more, so that a second frame confirms what is there.";
    case Weakness::kSelfSimilar:
      return "A new survey will not help. Give the robots a prior here, or put something distinctive on the floor.";
    case Weakness::kStrained:
      return "Drive over it once more, slowly and with more overlap; check that the floor is flat and the camera is "
             "firmly mounted.";
    case Weakness::kNotFound:
      return "Drive over it once more, and check the held-out frame's image.";
    case Weakness::kNone:
      break;
  }
  return "";
}

std::string Describe(const Zone& zone) {
  std::string text;
  switch (zone.weakness) {
    case Weakness::kFewKeypoints:
    case Weakness::kSelfSimilar:
    case Weakness::kObservedOnce:
      text = "down to " + NumberText(static_cast<int>(std::lround(zone.usable_in_view))) + " usable keypoints in view";
      break;
    case Weakness::kNotSurveyed:
      text = zone.lost_frames > 0 ? "frames covered this place, but could not be used" : "no frame covers this place";
      break;
    case Weakness::kStrained:
      text = "measured overlaps and poses disagree by more than measurement errors explain";
      break;
    default:
      text = "the floor's numbers are fine";
  }
  if (zone.held_out_failures > 0) {
    text += "; " + NumberText(zone.held_out_failures) + " held-out frame" + (zone.held_out_failures > 1 ? "s" : "") +
            " not found";
  }
  if (zone.lost_frames > 0) {
    text += "; " + NumberText(zone.lost_frames) + " frame" + (zone.lost_frames > 1 ? "s" : "") + " left out here";
  }
  return text;
}

}  // namespace floorloc
