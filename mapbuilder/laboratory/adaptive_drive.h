// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/surface/texture/texture_classifier.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/laboratory/article_detectors.h"
#include "mapbuilder/surface/patch_tracker.h"

namespace floorloc {

/// What a detector finds in an image of a drive, and with the one before.
struct DetectionScore {
  double detect_ms = 0.0;  ///< thread's time
  int keypoints = 0;
  int correct = 0;        ///< matches with the image before that agree with the true motion
  int inliers = 0;        ///< of the motion that RANSAC finds
  Pose2 before_from_now;  ///< that motion of the base; identity without inliers
};

/// One image of a drive.
struct AdaptiveFrame {
  TextureClass texture = TextureClass::kUnknown;
  double assess_ms = 0.0;
  Pose2 map_from_base;                                                            ///< true
  std::array<std::optional<DetectionScore>, kArticleDetectors.size()> detectors;  ///< empty: not in this build
};

struct AdaptiveDriveOptions {
  int width_px = 320;  ///< of the rectified images, as the article's; smaller ones stay as they are
  ArticleDetectorOptions detectors;
  PatchTrackerOptions tracker;
  double correct_px = 2.0;  ///< a match farther from its true place is wrong
  bool mask_shadow = true;  ///< no keypoints in blocks in shadow
  int repetitions = 3;      ///< of what is timed; the fastest counts, which other work disturbs least
  ProgressOutput progress;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Measures every detector on a drive in the survey format with groundtruth.tum. Throws InputError.
std::vector<AdaptiveFrame> MeasureAdaptiveDrive(const std::filesystem::path& drive, const TextureClassifier& classifier,
                                                const AdaptiveDriveOptions& options);

}  // namespace floorloc
