// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/ros_messages.h"

#include <cmath>

#include "mapbuilder/bag/message_reader.h"

namespace floorloc {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::string FrameId(MessageReader& reader) {
  std::string frame = reader.Text();
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

RosHeader ReadHeader(MessageReader& reader) {
  if (reader.is_ros1()) {
    reader.Unsigned32();  // seq
  }
  RosHeader header;
  // Seconds are unsigned in ROS 1, signed in ROS 2.
  const std::int64_t seconds = reader.is_ros1() ? std::int64_t{reader.Unsigned32()} : reader.Signed32();
  header.stamp_ns = seconds * kNsPerSecond + reader.Unsigned32();
  header.frame_id = FrameId(reader);
  return header;
}

Eigen::Vector3d ReadVector(MessageReader& reader) {
  const double x = reader.Real();
  const double y = reader.Real();
  const double z = reader.Real();
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
    reader.Fail("has numbers that are not finite; leave the topic out, or correct the driver");
  }
  return {x, y, z};
}

// Position (or translation) and quaternion x, y, z, w.
Eigen::Isometry3d ReadPose(MessageReader& reader) {
  const Eigen::Vector3d position = ReadVector(reader);
  const Eigen::Vector3d imaginary = ReadVector(reader);
  Eigen::Quaterniond rotation(reader.Real(), imaginary.x(), imaginary.y(), imaginary.z());
  constexpr double kMinNorm = 1e-3;
  if (!(rotation.norm() > kMinNorm)) {  // not NaN, either
    reader.Fail("has a quaternion that is no rotation; leave the topic out, or correct the driver");
  }
  return Eigen::Translation3d(position) * rotation.normalized();
}

}  // namespace

bool HasHeader(const std::string& type) {
  return IsImageType(type) || IsPoseType(type) || type == "sensor_msgs/CameraInfo" || type == "sensor_msgs/Imu";
}

bool IsImageType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

bool IsPoseType(const std::string& type) {
  return type == "nav_msgs/Odometry" || type == "geometry_msgs/PoseStamped" ||
         type == "geometry_msgs/PoseWithCovarianceStamped";
}

bool IsTransformType(const std::string& type) { return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage"; }

RosHeader ParseHeader(const BagMessage& message) {
  MessageReader reader(message);
  return ReadHeader(reader);
}

RosCompressedImage ParseCompressedImage(const BagMessage& message) {
  MessageReader reader(message);
  RosCompressedImage image;
  image.header = ReadHeader(reader);
  image.format = reader.Text();
  image.data = reader.Bytes();
  return image;
}

RosImage ParseImage(const BagMessage& message) {
  MessageReader reader(message);
  RosImage image;
  image.header = ReadHeader(reader);
  image.height_px = reader.Unsigned32();
  image.width_px = reader.Unsigned32();
  image.encoding = reader.Text();
  image.big_endian = reader.Byte() != 0;
  image.row_bytes = reader.Unsigned32();
  image.data = reader.Bytes();
  return image;
}

RosCameraInfo ParseCameraInfo(const BagMessage& message) {
  MessageReader reader(message);
  RosCameraInfo info;
  info.header = ReadHeader(reader);
  info.height_px = reader.Unsigned32();
  info.width_px = reader.Unsigned32();
  info.distortion_model = reader.Text();
  info.d = reader.Reals();
  info.k = reader.FixedReals<9>();
  info.r = reader.FixedReals<9>();
  info.p = reader.FixedReals<12>();
  info.binning_x = reader.Unsigned32();
  info.binning_y = reader.Unsigned32();
  info.roi_x_offset = reader.Unsigned32();
  info.roi_y_offset = reader.Unsigned32();
  info.roi_height_px = reader.Unsigned32();
  info.roi_width_px = reader.Unsigned32();
  return info;
}

RosPose ParsePose(const BagMessage& message) {
  MessageReader reader(message);
  RosPose pose;
  pose.header = ReadHeader(reader);
  if (PlainType(message.connection->type) == "nav_msgs/Odometry") {
    pose.child_frame_id = FrameId(reader);
  }
  pose.pose = ReadPose(reader);
  return pose;
}

RosImu ParseImu(const BagMessage& message) {
  MessageReader reader(message);
  RosImu imu;
  imu.header = ReadHeader(reader);
  reader.FixedReals<4>();  // orientation, which many IMUs do not know
  reader.FixedReals<9>();
  imu.angular_velocity = ReadVector(reader);
  reader.FixedReals<9>();
  imu.acceleration = ReadVector(reader);
  return imu;
}

std::vector<RosTransform> ParseTransforms(const BagMessage& message) {
  MessageReader reader(message);
  constexpr std::size_t kMinBytes = 8 + 2 * 4 + 7 * 8;  // stamp, two empty names, translation and rotation
  std::vector<RosTransform> transforms(reader.Count(kMinBytes));
  for (RosTransform& transform : transforms) {
    transform.header = ReadHeader(reader);
    transform.child_frame_id = FrameId(reader);
    transform.parent_from_child = ReadPose(reader);
  }
  return transforms;
}

}  // namespace floorloc
