// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace floorloc {

/// Follows the framing of a chunked body (RFC 9112, section 7.1) as its bytes pass by: sizes of hexadecimal digits
/// only, lines that end with CR LF, extensions that are skipped, no trailers.
class ChunkedFraming {
 public:
  /// False, from then on, when the bytes so far are not the beginning of a chunked body, or go on after its end.
  bool Accept(std::string_view bytes);
  bool complete() const { return state_ == State::kEnd; }

 private:
  enum class State {
    kSize,
    kExtension,
    kSizeLineFeed,
    kData,
    kDataReturn,
    kDataLineFeed,
    kLastReturn,
    kLastLineFeed,
    kEnd,
    kBroken
  };

  State Next(char c);
  State AfterSize(char c);

  State state_ = State::kSize;
  std::size_t left_ = 0;    // bytes of this chunk
  std::size_t digits_ = 0;  // of the size, or bytes of an extension
};

}  // namespace floorloc
