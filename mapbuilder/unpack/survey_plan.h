// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/unpack/bag_summary.h"
#include "mapbuilder/unpack/camera_mounting.h"

namespace floorloc {

/// For an option that names a topic: leave what it would name out.
inline constexpr const char* kNoTopic = "none";

/// Which topics and files of a bag a survey is made of. Empty topics: the only one of its type.
struct SurveyChoice {
  std::string image_topic;
  std::string camera_info_topic;
  std::string odom_topic;               ///< or kNoTopic; Odometry, PoseStamped or PoseWithCovarianceStamped
  std::string imu_topic;                ///< or kNoTopic
  std::string truth_topic;              ///< of poses in the map; empty: none
  std::string odom_frame;               ///< of /tf, instead of a topic; empty: "odom"
  std::string base_frame;               ///< empty: the child of the odometry, else base_footprint or base_link
  std::filesystem::path camera_yaml;    ///< instead of CameraInfo
  std::filesystem::path floor_yaml;     ///< instead of /tf_static
  std::optional<double> base_height_m;  ///< of the base frame's origin over the floor; empty: by base_footprint, else 0
  bool needs_floor = true;              ///< false: a camera that need not see the floor (monocular odometry)
  MountingOptions mounting;
};

/// Where poses come from: a topic, or a transform of /tf.
struct PoseSource {
  std::string topic;          ///< empty: of /tf
  std::string parent, child;  ///< of /tf
  Eigen::Isometry3d child_from_base = Eigen::Isometry3d::Identity();
};

/// What a survey folder is made of.
struct SurveyPlan {
  std::string image_topic;
  std::string base_frame;
  CameraModel camera;
  std::optional<FloorPlane> floor;  ///< empty: missing, or not needed
  std::string mounting;             ///< where it comes from
  std::optional<PoseSource> odometry;
  std::optional<PoseSource> truth;
  std::string imu_topic;  ///< empty: none
  Eigen::Matrix3d base_from_imu = Eigen::Matrix3d::Identity();
  std::vector<std::string> missing;  ///< without which there is no survey: a sentence each, which says what to do
  std::vector<std::string> notes;    ///< what was chosen, and why; a sentence each
};

/// Never throws for what the bag lacks: that is in `missing`. Throws InputError for camera_yaml and floor_yaml.
SurveyPlan PlanSurvey(const BagSummary& bag, const SurveyChoice& choice);

}  // namespace floorloc
