// SPDX-License-Identifier: Apache-2.0
#include "server/wire/chunked_framing.h"

#include <algorithm>

namespace floorloc {
namespace {

constexpr std::size_t kMaxSizeDigits = 8;  // 4 GiB: bodies are limited to much less
constexpr std::size_t kMaxExtensionBytes = 256;

int HexDigit(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

}  // namespace

bool ChunkedFraming::Accept(std::string_view bytes) {
  while (!bytes.empty() && state_ != State::kBroken) {
    if (state_ == State::kData) {
      const std::size_t taken = std::min(left_, bytes.size());
      left_ -= taken;
      bytes.remove_prefix(taken);
      state_ = left_ == 0 ? State::kDataReturn : State::kData;
      continue;
    }
    state_ = Next(bytes.front());
    bytes.remove_prefix(1);
  }
  return state_ != State::kBroken;
}

ChunkedFraming::State ChunkedFraming::Next(char c) {
  switch (state_) {
    case State::kSize:
      return AfterSize(c);
    case State::kExtension:
      if (c == '\r') {
        return State::kSizeLineFeed;
      }
      return ++digits_ <= kMaxExtensionBytes && (c == '\t' || (c >= 0x20 && c <= 0x7E)) ? State::kExtension
                                                                                        : State::kBroken;
    case State::kSizeLineFeed:
      digits_ = 0;
      return c != '\n' ? State::kBroken : left_ == 0 ? State::kLastReturn : State::kData;
    case State::kDataReturn:
      return c == '\r' ? State::kDataLineFeed : State::kBroken;
    case State::kDataLineFeed:
      return c == '\n' ? State::kSize : State::kBroken;
    case State::kLastReturn:
      return c == '\r' ? State::kLastLineFeed : State::kBroken;
    case State::kLastLineFeed:
      return c == '\n' ? State::kEnd : State::kBroken;
    default:
      return State::kBroken;
  }
}

ChunkedFraming::State ChunkedFraming::AfterSize(char c) {
  const int digit = HexDigit(c);
  if (digit >= 0 && digits_ < kMaxSizeDigits) {
    left_ = 16 * left_ + static_cast<std::size_t>(digit);
    ++digits_;
    return State::kSize;
  }
  if (digits_ > 0 && c == '\r') {
    return State::kSizeLineFeed;
  }
  if (digits_ > 0 && c == ';') {
    digits_ = 0;
    return State::kExtension;
  }
  return State::kBroken;
}

}  // namespace floorloc
