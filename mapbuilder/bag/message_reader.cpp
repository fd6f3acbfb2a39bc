// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/message_reader.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;

// The representation identifiers of DDS-XTypes 1.3, table 60, that ROS 2 writes. The lowest bit is the byte order.
constexpr std::uint8_t kPlainCdr = 0x00;
constexpr std::uint8_t kPlainCdr2 = 0x06;

template <typename Number>
Number FromBytes(std::span<const std::uint8_t> bytes, bool big_endian) {
  std::array<std::uint8_t, sizeof(Number)> ordered{};
  std::copy(bytes.begin(), bytes.end(), ordered.begin());
  if (big_endian != (std::endian::native == std::endian::big)) {
    std::reverse(ordered.begin(), ordered.end());
  }
  return std::bit_cast<Number>(ordered);
}

}  // namespace

MessageReader::MessageReader(const BagMessage& message)
    : connection_(*message.connection),
      bytes_(message.bytes),
      ros1_(connection_.serialization == Serialization::kRos1) {
  if (ros1_) {
    max_alignment_ = 1;
    return;
  }
  if (connection_.serialization != Serialization::kCdr) {
    Fail("is in neither of ROS's serializations; record it with ROS's own tools");
  }
  if (bytes_.size() < kEncapsulationBytes || bytes_[0] != 0 ||
      ((bytes_[1] & 0xFE) != kPlainCdr && (bytes_[1] & 0xFE) != kPlainCdr2)) {
    Fail("does not begin like a message of ROS 2; copy the bag again");
  }
  big_endian_ = (bytes_[1] & 1) == 0;
  max_alignment_ = (bytes_[1] & 0xFE) == kPlainCdr2 ? 4 : 8;
  bytes_ = bytes_.subspan(kEncapsulationBytes);
}

void MessageReader::Fail(const std::string& what) const {
  throw InputError("topic " + connection_.topic + ": a message of " + connection_.type + " " + what);
}

std::span<const std::uint8_t> MessageReader::Take(std::size_t size, std::size_t alignment) {
  const std::size_t to = std::min(alignment, max_alignment_);
  const std::size_t begin = (at_ + to - 1) / to * to;
  if (begin > bytes_.size() || size > bytes_.size() - begin) {
    Fail("ends too early; the bag is damaged, or the type has other fields than ROS's");
  }
  at_ = begin + size;
  return bytes_.subspan(begin, size);
}

std::uint32_t MessageReader::Unsigned32() { return FromBytes<std::uint32_t>(Take(4, 4), big_endian_); }

double MessageReader::Real() { return FromBytes<double>(Take(8, 8), big_endian_); }

std::size_t MessageReader::Count(std::size_t min_bytes) {
  const std::uint32_t count = Unsigned32();
  if (count > (bytes_.size() - at_) / min_bytes) {
    Fail("ends too early; the bag is damaged, or the type has other fields than ROS's");
  }
  return count;
}

std::span<const std::uint8_t> MessageReader::Bytes() { return Take(Count(1), 1); }

std::string MessageReader::Text() {
  const std::span<const std::uint8_t> bytes = Bytes();
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!ros1_ && text.ends_with('\0')) {
    text.pop_back();
  }
  return text;
}

std::vector<double> MessageReader::Reals() {
  std::vector<double> numbers(Count(sizeof(double)));
  for (double& number : numbers) {
    number = Real();
  }
  return numbers;
}

}  // namespace floorloc
