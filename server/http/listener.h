// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/io/file_descriptor.h"

namespace floorloc {

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
