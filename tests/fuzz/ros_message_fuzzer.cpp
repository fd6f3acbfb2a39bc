// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "core/io/input_error.h"
#include "mapbuilder/bag/ros_image.h"
#include "mapbuilder/bag/ros_messages.h"
#include "tests/fuzz/refusal.h"

namespace {

void Parse(const floorloc::BagMessage& message) {
  using namespace floorloc;
  const std::string type = PlainType(message.connection->type);
  if (IsImageType(type)) {
    ToImageFile(message);
  } else if (IsPoseType(type)) {
    ParsePose(message);
  } else if (IsTransformType(type)) {
    ParseTransforms(message);
  } else if (type == "sensor_msgs/CameraInfo") {
    ParseCameraInfo(message);
  } else {
    ParseImu(message);
  }
}

}  // namespace

// The first byte chooses the type and the serialization.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  constexpr const char* kTypes[] = {"sensor_msgs/Image", "sensor_msgs/CompressedImage", "sensor_msgs/CameraInfo",
                                    "sensor_msgs/Imu",   "nav_msgs/Odometry",           "geometry_msgs/PoseStamped",
                                    "tf2_msgs/TFMessage"};
  if (size == 0) {
    return 0;
  }
  BagConnection connection;
  connection.topic = "/fuzzed";
  connection.type = kTypes[(data[0] & 0x7F) % std::size(kTypes)];
  connection.serialization = (data[0] & 0x80) != 0 ? Serialization::kRos1 : Serialization::kCdr;
  const BagMessage message{&connection, 0, {data + 1, size - 1}};
  MayRefuse<InputError>([&] { Parse(message); });
  MayRefuse<InputError>([&] { ParseHeader(message); });
  return 0;
}
