// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mapbuilder/bag/bag_reader.h"

namespace floorloc {

// The messages of ROS 1 and 2 that a survey or a drive is made of, in the fields that are used. Each Parse function
// throws InputError, which names the topic, when the message is cut off or has numbers that are not finite.

struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame_id;  ///< without the slash that early tf put before it
};

/// sensor_msgs/CompressedImage. `data` points into the message.
struct RosCompressedImage {
  RosHeader header;
  std::string format;
  std::span<const std::uint8_t> data;
};

/// sensor_msgs/Image. `data` points into the message.
struct RosImage {
  RosHeader header;
  std::uint32_t height_px = 0;
  std::uint32_t width_px = 0;
  std::string encoding;
  bool big_endian = false;
  std::uint32_t row_bytes = 0;
  std::span<const std::uint8_t> data;
};

/// sensor_msgs/CameraInfo.
struct RosCameraInfo {
  RosHeader header;
  std::uint32_t height_px = 0;
  std::uint32_t width_px = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};
  std::array<double, 9> r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  std::uint32_t roi_x_offset = 0;
  std::uint32_t roi_y_offset = 0;
  std::uint32_t roi_height_px = 0;
  std::uint32_t roi_width_px = 0;
};

/// Pose of nav_msgs/Odometry, geometry_msgs/PoseStamped and geometry_msgs/PoseWithCovarianceStamped:
/// header.frame_id from child_frame_id.
struct RosPose {
  RosHeader header;
  std::string child_frame_id;  ///< empty but in Odometry
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
};

/// sensor_msgs/Imu: rad/s and m/s^2 in the frame of the header.
struct RosImu {
  RosHeader header;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// geometry_msgs/TransformStamped: header.frame_id (the parent) from child_frame_id.
struct RosTransform {
  RosHeader header;
  std::string child_frame_id;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
};

/// Of any type whose first field is std_msgs/Header.
RosHeader ParseHeader(const BagMessage& message);
RosCompressedImage ParseCompressedImage(const BagMessage& message);
RosImage ParseImage(const BagMessage& message);
RosCameraInfo ParseCameraInfo(const BagMessage& message);
/// By the type of the connection.
RosPose ParsePose(const BagMessage& message);
RosImu ParseImu(const BagMessage& message);
/// tf2_msgs/TFMessage or tf/tfMessage.
std::vector<RosTransform> ParseTransforms(const BagMessage& message);

/// The plain types that begin with std_msgs/Header and are read here.
bool HasHeader(const std::string& plain_type);
bool IsImageType(const std::string& plain_type);
bool IsPoseType(const std::string& plain_type);
bool IsTransformType(const std::string& plain_type);

}  // namespace floorloc
