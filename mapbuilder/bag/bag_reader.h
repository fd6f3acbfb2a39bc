// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace floorloc {

/// How the messages of a topic are written.
enum class Serialization {
  kCdr,    ///< ROS 2: OMG CDR behind an encapsulation header
  kRos1,   ///< ROS 1: little-endian, without padding
  kOther,  ///< not read; counted only
};

struct BagConnection {
  std::string topic;
  std::string type;        ///< as the bag has it: "sensor_msgs/msg/Image", of ROS 1 "sensor_msgs/Image"
  std::string definition;  ///< text of the message definition; empty where the bag has none
  Serialization serialization = Serialization::kOther;
};

/// "sensor_msgs/Image", of either ROS.
std::string PlainType(const std::string& type);

struct BagMessage {
  const BagConnection* connection = nullptr;  ///< valid until the next message is read
  std::int64_t record_ns = 0;                 ///< when it was recorded
  std::span<const std::uint8_t> bytes;        ///< valid until the next message is read
};

/// Reads the messages of a bag in the order of its files. Memory holds one chunk (or message) at a time, at most
/// kMaxBagRecordBytes of it.
class BagReader {
 public:
  BagReader() = default;
  virtual ~BagReader() = default;
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  /// Empty at the end. Throws InputError for a damaged bag, with the place and what to do. A bag that ends too early is
  /// read as far as it goes, and warnings() then says what was cut.
  virtual std::optional<BagMessage> Next() = 0;

  /// One sentence each.
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  void Warn(std::string sentence) { warnings_.push_back(std::move(sentence)); }

 private:
  std::vector<std::string> warnings_;
};

/// The largest chunk or message that is read: as much as the largest image file.
inline constexpr std::uint64_t kMaxBagRecordBytes = 256u << 20;

}  // namespace floorloc
