// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/mounting.h"
#include "core/geometry/pose2.h"
#include "core/io/survey.h"
#include "core/vision/features/features.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/survey/image_quality.h"

namespace floorloc {

/// A survey with the rectifier of its camera.
struct LoadedSurvey {
  Survey survey;
  FloorCamera given_camera;  ///< of the survey's files; survey.camera may have been corrected
  std::shared_ptr<const Rectifier> rectifier;
};

/// External pose measurement of a frame.
struct AbsolutePosePrior {
  Pose2 map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive
};

/// One frame of a survey as kept in memory by the builder, without its image.
struct BuildFrame {
  int survey = 0;  ///< index of its survey
  SurveyFrame info;
  Features features;   ///< base frame
  cv::Mat brightness;  ///< CV_32F, mean grey of coarse cells of the rectified image; 0: invalid
  ImageQuality quality;
  cv::Mat texture;         ///< SampleBlockTextures() of the rectified image
  std::string unreadable;  ///< reason if the image can't be used; else empty
  /// The camera's height while the image was taken over that of its survey's calibration; `features` are corrected for
  /// it.
  double height_ratio = 1.0;
  /// Of the camera while the image was taken, by self-calibration; `features` are corrected for it.
  MountingError mounting_error;
  /// ReadoutMotion::motion while the image was taken, by odometry; `features` are corrected for it.
  Eigen::Vector3d readout_motion = Eigen::Vector3d::Zero();
  std::optional<Pose2> odom_from_base;     ///< if the survey has odometry at the frame's stamp
  bool odometry_breaks = false;            ///< odometry does not know the motion from the survey's frame before
  std::optional<AbsolutePosePrior> prior;  ///< from another system or from localization in the map being extended
};

/// Frames with their surveys, passed between the stages of a build.
struct FrameSet {
  std::vector<LoadedSurvey> surveys;
  std::vector<BuildFrame> frames;

  /// The region of interest of every frame, base frame.
  std::vector<RectM> FloorsInBase() const;
};

/// The survey's camera at the height that it had over the frame.
FloorCamera CameraOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys);

/// Floor point that a raw pixel of the frame sees, base frame when its middle row is exposed.
Eigen::Vector2d FloorPointOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys,
                             const Eigen::Vector2d& raw_px);
/// The other way round.
Eigen::Vector2d RawPixelOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys,
                           const Eigen::Vector2d& point_in_base_m);

/// The region of interest of every frame, base frame.
std::vector<RectM> FloorsInBase(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys);

/// Side of a cell of BuildFrame::brightness, pixels of the rectified image.
constexpr int kBrightnessCellPx = 24;

}  // namespace floorloc
