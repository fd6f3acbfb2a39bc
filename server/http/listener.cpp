// SPDX-License-Identifier: Apache-2.0
#include "server/http/listener.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

namespace floorloc {
namespace {

constexpr int kBacklog = 511;

int PortOf(int socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  std::array<char, NI_MAXSERV> service{};
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      ::getnameinfo(reinterpret_cast<sockaddr*>(&address), length, nullptr, 0, service.data(), service.size(),
                    NI_NUMERICSERV) != 0) {
    return 0;
  }
  return std::stoi(service.data());
}

// Without SO_REUSEPORT: a second server on the same port must fail instead of receiving half of the requests.
FileDescriptor OpenSocket(const addrinfo& address) {
  FileDescriptor socket(::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC, address.ai_protocol));
  const int yes = 1;
  if (socket.get() < 0 || ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
      ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes) != 0 ||
      ::bind(socket.get(), address.ai_addr, address.ai_addrlen) != 0 || ::listen(socket.get(), kBacklog) != 0) {
    return FileDescriptor();
  }
  return socket;
}

}  // namespace

Listener Listen(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) {
    throw std::runtime_error("--listen " + host + ": " + ::gai_strerror(error) + "; name an address of this machine.");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  Listener listener;
  listener.socket = OpenSocket(*addresses);
  if (listener.socket.get() < 0) {
    throw std::runtime_error("--listen " + host + ":" + std::to_string(port) + ": " + std::strerror(errno) +
                             "; choose another port or stop the program that uses it.");
  }
  listener.port = PortOf(listener.socket.get());
  return listener;
}

std::string RemoteAddress(int socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  std::array<char, NI_MAXHOST> host{};
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0 ||
      ::getnameinfo(reinterpret_cast<sockaddr*>(&address), length, host.data(), host.size(), nullptr, 0,
                    NI_NUMERICHOST) != 0) {
    return "";
  }
  return host.data();
}

}  // namespace floorloc
