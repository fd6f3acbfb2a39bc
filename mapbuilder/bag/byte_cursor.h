// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

namespace floorloc {

static_assert(std::endian::native == std::endian::little, "records of bags are little-endian");

/// Reads little-endian numbers and strings one after the other. What is not wholly there is empty, and so is everything
/// after it.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename Number>
  std::optional<Number> Get() {
    const auto bytes = Bytes(sizeof(Number));
    if (!bytes) {
      return std::nullopt;
    }
    Number number;
    std::memcpy(&number, bytes->data(), sizeof(Number));
    return number;
  }

  std::optional<std::span<const std::uint8_t>> Bytes(std::uint64_t size) {
    if (size > bytes_.size()) {
      bytes_ = {};
      return std::nullopt;
    }
    const auto bytes = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return bytes;
  }

  /// Bytes behind a length of 32 bits.
  std::optional<std::string_view> String() {
    const auto size = Get<std::uint32_t>();
    const auto bytes = size ? Bytes(*size) : std::nullopt;
    return bytes ? std::optional(std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()))
                 : std::nullopt;
  }

  std::span<const std::uint8_t> rest() const { return bytes_; }
  bool empty() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace floorloc
