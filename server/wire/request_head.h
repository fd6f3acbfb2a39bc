// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace floorloc {

inline constexpr std::size_t kMaxRequestLineBytes = std::size_t{8} << 10;
inline constexpr std::size_t kMaxHeaderLineBytes = std::size_t{8} << 10;
inline constexpr std::size_t kMaxHeadBytes = std::size_t{32} << 10;
inline constexpr std::size_t kMaxHeaders = 100;

enum class BodyFraming { kNone, kLength, kChunked };

/// What decides where a request ends, and what follows it.
struct RequestHead {
  BodyFraming framing = BodyFraming::kNone;
  std::uint64_t content_length = 0;
  bool keep_alive = true;
  bool expects_continue = false;
};

/// Finds the empty line at the end of a head in bytes that grow.
class HeadScanner {
 public:
  /// bytes: all so far, at least those of the previous call. Size of the head with its empty line; or of all bytes as
  /// soon as one of them cannot be part of a head, so that nobody waits for its end; empty: more must come.
  std::optional<std::size_t> FindEnd(std::string_view bytes);

 private:
  std::size_t scanned_ = 0;
};

/// Parses a head as strictly as RFC 9112 allows, so that no proxy and no library finds another end of the request in
/// it. Throws Problem: 400 malformed_request, 414 uri_too_long, 417 expectation_failed, 431
/// head_too_large, 501 unknown_method or unknown_transfer_coding, 505 unsupported_http_version.
RequestHead ParseRequestHead(std::string_view head);

/// The problem of a head that is larger than kMaxHeadBytes: 414 when it has no line end, else 431.
[[noreturn]] void ThrowHeadTooLarge(std::string_view begin);

}  // namespace floorloc
