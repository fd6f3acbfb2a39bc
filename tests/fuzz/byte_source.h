// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace floorloc {

/// Takes choices off the front of a fuzzer's input, in an order that make_corpus.py can write too. Behind the end
/// everything is 0.
class ByteSource {
 public:
  explicit ByteSource(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool empty() const { return rest_.empty(); }
  std::uint8_t Byte() {
    const std::uint8_t byte = rest_.empty() ? std::uint8_t{0} : rest_.front();
    rest_ = rest_.subspan(std::min<std::size_t>(1, rest_.size()));
    return byte;
  }
  /// From 0 to count - 1; count > 0, at most 256.
  std::size_t Below(std::size_t count) { return Byte() % count; }
  /// Two bytes, the lower one first.
  std::size_t Short() {
    const std::size_t low = Byte();
    return low | static_cast<std::size_t>(Byte()) << 8;
  }
  /// Everything up to the next zero byte, which goes too.
  std::string Text() {
    const auto end = std::find(rest_.begin(), rest_.end(), std::uint8_t{0});
    const std::string text(rest_.begin(), end);
    rest_ = rest_.subspan(std::min(text.size() + 1, rest_.size()));
    return text;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace floorloc
