// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace floorloc {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

/// Thrown by ModelReader when the bytes end too early, or a length is beyond its limit.
struct ModelDamage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Appends numbers as they are in memory.
class ModelWriter {
 public:
  template <typename Number>
  void Add(const Number& number) {
    AddAll(&number, 1);
  }
  template <typename Number>
  void AddAll(const Number* numbers, std::size_t count) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
  }
  void AddLength(std::size_t length) { Add(static_cast<std::uint32_t>(length)); }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Takes numbers from bytes of unknown origin.
class ModelReader {
 public:
  explicit ModelReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number Take() {
    Number number = {};
    TakeAll(&number, 1);
    return number;
  }
  template <typename Number>
  void TakeAll(Number* numbers, std::size_t count) {
    static_assert(std::is_arithmetic_v<Number>);
    Require(count * sizeof(Number));
    if (count > 0) {
      std::memcpy(numbers, bytes_.data(), count * sizeof(Number));
    }
    bytes_.remove_prefix(count * sizeof(Number));
  }
  std::size_t TakeLength(std::size_t limit) {
    const std::size_t length = Take<std::uint32_t>();
    if (length > limit) {
      throw ModelDamage("a list is too long");
    }
    return length;
  }
  /// Throws when fewer bytes are left: to be asked before memory is taken for them.
  void Require(std::size_t bytes) const {
    if (bytes_.size() < bytes) {
      throw ModelDamage("the file ends too early");
    }
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

}  // namespace floorloc
