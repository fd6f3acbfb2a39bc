// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace floorloc {

/// Owns a file descriptor.
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

/// Binds to host:port; port 0 takes any free port. Throws std::runtime_error.
Listener Listen(const std::string& host, int port);

/// Peer address, or "" when the peer has disconnected.
std::string RemoteAddress(int socket);

}  // namespace floorloc
