// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/screening/fixed_structure.h"
#include "mapbuilder/screening/moving_pairs.h"

namespace floorloc {

struct AutoMaskOptions {
  bool apply = true;  ///< false: what moves with the camera is only reported
  MovingPairOptions pairs;
  FixedStructureOptions structure;
  RunOptions run = {};

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

enum class CameraMaskStatus {
  kGiven,      ///< the survey has a mask; nothing was looked for
  kNothing,    ///< nothing moves with the camera
  kUndecided,  ///< too few images that show the floor moving
  kFound,
};

const char* ToString(CameraMaskStatus status);
/// Empty for an unknown name.
std::optional<CameraMaskStatus> ParseCameraMaskStatus(const std::string& name);

/// What in a survey's images is not floor but moves with the camera.
struct CameraMaskFinding {
  CameraMaskStatus status = CameraMaskStatus::kUndecided;
  bool applied = false;               ///< the map was built without what is masked
  double share = 0.0;                 ///< of the image
  int pairs = 0;                      ///< of images that showed the floor moving
  cv::Mat mask;                       ///< CV_8UC1 of the camera's size, 0 where it is not floor; empty: no mask
  std::vector<std::uint8_t> picture;  ///< JPEG of an image of the survey with the mask; empty: none
};

/// Looks for it in every survey without a mask; one finding per survey.
std::vector<CameraMaskFinding> FindCameraMasks(const FrameSet& set, const PairRegistrationOptions& registration,
                                               const AutoMaskOptions& options);

/// The survey with a mask of its camera. Throws std::invalid_argument when it is none of this camera.
LoadedSurvey WithMask(LoadedSurvey survey, const cv::Mat& mask);

}  // namespace floorloc
