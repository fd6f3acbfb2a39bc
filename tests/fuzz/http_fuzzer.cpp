// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "server/api/app.h"
#include "server/http/http_server.h"
#include "server/http/listener.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

ServerConfig SmallConfig() {
  spdlog::set_level(spdlog::level::off);
  ServerConfig config;
  config.threads = 1;
  config.limits.http.max_body_bytes = std::size_t{64} << 10;
  return config;
}

/// The whole server, without a map.
struct Server {
  TemporaryFolder maps;
  App app{SmallConfig(), maps.path()};
  HttpServer http{{"127.0.0.1", 0, app.state().config.limits.http}, app.router()};
  std::thread thread{[this] { http.Serve(); }};
};

FileDescriptor Connect(int port) {
  FileDescriptor connection(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(connection.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    std::abort();
  }
  return connection;
}

}  // namespace
}  // namespace floorloc

// The bytes that a client sends on one connection: heads and bodies, multipart ones too. Every answer is one of HTTP.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static auto* server = new floorloc::Server;  // its thread never ends
  const floorloc::FileDescriptor connection = floorloc::Connect(server->http.port());
  ::send(connection.get(), data, size, MSG_NOSIGNAL);
  ::shutdown(connection.get(), SHUT_WR);
  std::array<char, 4096> answer{};
  ssize_t count = ::recv(connection.get(), answer.data(), answer.size(), 0);
  if (count > 0 && !std::string_view(answer.data(), static_cast<std::size_t>(count)).starts_with("HTTP/1.")) {
    std::abort();
  }
  while (count > 0) {
    count = ::recv(connection.get(), answer.data(), answer.size(), 0);
  }
  return 0;
}
