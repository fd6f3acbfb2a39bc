// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace floorloc {

/// Reads one HTTP/1.1 response with a Content-Length from the bytes of a connection as they come.
class HttpResponse {
 public:
  enum class Progress { kIncomplete, kWhole, kMalformed };

  /// Bytes that come after the response are left alone.
  Progress Add(std::string_view bytes);
  void Clear() { *this = HttpResponse(); }

  // Of a whole response:

  int status() const { return status_; }
  std::string_view body() const { return std::string_view(bytes_).substr(head_size_); }
  /// True when the server will close the connection.
  bool closes() const { return closes_; }

 private:
  bool ParseHead();

  std::string bytes_;
  std::size_t head_size_ = 0;  // with the empty line; 0: not whole yet
  std::size_t body_size_ = 0;
  int status_ = 0;
  bool closes_ = false;
};

}  // namespace floorloc
