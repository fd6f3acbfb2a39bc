// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace floorloc {

/// A file descriptor that closes itself.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() { Reset(); }
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(other.Release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;

  int get() const { return fd_; }
  int Release();
  void Reset();

 private:
  int fd_ = -1;
};

/// A listening TCP socket.
struct Listener {
  FileDescriptor socket;
  int port = 0;
};

/// Binds to host:port; port 0 takes any free one. Throws std::runtime_error with one sentence.
Listener Listen(const std::string& host, int port);

/// Address of the other end, "" when it is gone.
std::string RemoteAddress(int socket);

}  // namespace floorloc
