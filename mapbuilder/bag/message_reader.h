// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mapbuilder/bag/bag_reader.h"

namespace floorloc {

/// Reads the fields of a message one after the other. ROS 1: little-endian without padding (wiki.ros.org/msg). ROS 2:
/// CDR of either byte order (OMG DDSI-RTPS 10.2, DDS-XTypes 7.4: PLAIN_CDR and PLAIN_CDR2), numbers aligned from behind
/// the encapsulation header. Throws InputError, which names the topic and its type, when a field is not there.
class MessageReader {
 public:
  explicit MessageReader(const BagMessage& message);

  std::uint8_t Byte() { return Take(1, 1)[0]; }
  std::uint32_t Unsigned32();
  std::int32_t Signed32() { return static_cast<std::int32_t>(Unsigned32()); }
  double Real();  ///< of 64 bits
  std::string Text();
  /// Bytes behind their count: in the message, not a copy.
  std::span<const std::uint8_t> Bytes();
  std::vector<double> Reals();  ///< behind their count
  template <std::size_t kCount>
  std::array<double, kCount> FixedReals() {
    std::array<double, kCount> numbers{};
    for (double& number : numbers) {
      number = Real();
    }
    return numbers;
  }
  /// Number of the elements that follow, of which each takes at least `min_bytes`.
  std::size_t Count(std::size_t min_bytes);

  bool is_ros1() const { return ros1_; }
  [[noreturn]] void Fail(const std::string& what) const;

 private:
  std::span<const std::uint8_t> Take(std::size_t size, std::size_t alignment);

  const BagConnection& connection_;
  std::span<const std::uint8_t> bytes_;  ///< behind the encapsulation header
  std::size_t at_ = 0;
  bool ros1_ = false;
  bool big_endian_ = false;
  std::size_t max_alignment_ = 8;
};

}  // namespace floorloc
