// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/io/survey.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/survey/image_quality.h"

namespace floorloc {

/// A survey with the rectifier of its camera.
struct LoadedSurvey {
  Survey survey;
  std::shared_ptr<const Rectifier> rectifier;
  /// mask.png of the folder: CV_8UC1 of the camera's images, 0 where they show no floor (the robot's body); may be
  /// empty.
  cv::Mat raw_mask = {};

  /// CV_8UC1 of the rectified image, 255 where it shows floor.
  cv::Mat FloorMask() const;
};

/// A pose known from outside.
struct AbsolutePosePrior {
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive
};

/// One frame of a survey, as far as the builder keeps it in memory: its image is not kept.
struct BuildFrame {
  int survey = 0;  ///< index of its survey
  SurveyFrame info;
  Features features;   ///< base frame
  cv::Mat brightness;  ///< CV_32F, mean grey of coarse cells of the rectified image; 0: unseen
  ImageQuality quality;
  std::string unreadable;                  ///< why the image can't be used; empty: it can
  std::optional<Pose2> odom_from_base;     ///< when the survey has odometry at the frame's time
  std::optional<AbsolutePosePrior> prior;  ///< a pose known from another system, or from the map to be extended
};

/// Frames with the surveys they are of: what the stages of a build hand on.
struct FrameSet {
  std::vector<LoadedSurvey> surveys;
  std::vector<BuildFrame> frames;

  /// The region of interest of every frame, base frame.
  std::vector<RectM> FloorsInBase() const;
};

/// Side of a cell of BuildFrame::brightness, pixels of the rectified image.
constexpr int kBrightnessCellPx = 24;

/// Reads the surveys and builds their rectifiers: all at resolution_m, or, if that is 0, at that of the first survey's
/// floor.yaml. Throws InputError.
std::vector<LoadedSurvey> LoadSurveys(const std::vector<std::filesystem::path>& folders,
                                      BadFramePolicy bad_frames = BadFramePolicy::kThrow, double resolution_m = 0.0);

class FrameJournal;

struct ExtractionOptions {
  ExtractorOptions extractor;
  int threads = 0;  ///< 0: one per core
  ProgressOutput progress;
  FrameJournal* journal = nullptr;  ///< what an earlier run of the build did, and where this one notes what it does
  BadFramePolicy bad_frames = BadFramePolicy::kThrow;  ///< kSkip: BuildFrame::unreadable instead of an error
};

/// Rectifies every frame of every survey and extracts its features. Throws InputError for an image that can't be
/// used, unless the options say otherwise.
std::vector<BuildFrame> ExtractSurveyFrames(const std::vector<LoadedSurvey>& surveys, const ExtractionOptions& options);

}  // namespace floorloc
