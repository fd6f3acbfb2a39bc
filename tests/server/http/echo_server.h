// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <future>
#include <string>
#include <thread>

#include "server/http/http_server.h"
#include "server/http/listener.h"

namespace floorloc {

/// Echoes the request; "/wait" blocks until released.
class EchoHandler : public HttpHandler {
 public:
  std::optional<HttpResponse> Admit(const HttpRequest& head) override {
    return head.path == "/refused" ? std::optional(Refuse(head, Problem(401, "unauthorized", "No."))) : std::nullopt;
  }
  bool IsHealthCheck(const HttpRequest& head) const override { return head.path == "/livez"; }
  HttpResponse Handle(HttpRequest request) override {
    if (request.path == "/wait") {
      waiting.set_value();
      released.get_future().wait();
    }
    std::string parts;
    for (const HttpPart& part : request.parts) {
      parts += "[" + part.name + "=" + part.content + "]";
    }
    return {200, "text/plain", request.method + " " + request.path + " " + request.body + parts, {}};
  }
  HttpResponse Refuse(const HttpRequest&, const Problem& problem) override { return ToResponse(problem); }

  std::promise<void> waiting;
  std::promise<void> released;
};

/// Sends raw bytes on a socket, for requests that no client library would send.
class RawClient {
 public:
  /// from: an address of this machine.
  explicit RawClient(int port, const char* from = "127.0.0.1") : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &own.sin_addr);
    EXPECT_EQ(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  void Send(const std::string& text) { ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL); }
  void CloseOutput() { ::shutdown(socket_.get(), SHUT_WR); }
  /// Waits for the next bytes.
  std::string ReadSome() const {
    std::array<char, 4096> buffer{};
    const ssize_t count = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
    return {buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }
  /// Everything until the server closes.
  std::string ReadAll() {
    std::string all;
    std::array<char, 4096> buffer{};
    for (;;) {
      const ssize_t count = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
      if (count <= 0) {
        return all;
      }
      all.append(buffer.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  FileDescriptor socket_;
};

/// A server that echoes.
class EchoServer {
 public:
  explicit EchoServer(const HttpLimits& limits = {})
      : server_({"127.0.0.1", 0, limits}, handler_), thread_([this] { server_.Serve(); }) {}
  ~EchoServer() { Stop(); }
  EchoServer(const EchoServer&) = delete;
  EchoServer& operator=(const EchoServer&) = delete;

  void Stop() {
    if (thread_.joinable()) {
      server_.Stop();
      thread_.join();
    }
  }
  /// What the server says to these bytes and then the end.
  std::string Exchange(const std::string& text) {
    RawClient client(server_.port());
    client.Send(text);
    client.CloseOutput();
    return client.ReadAll();
  }
  HttpServer& http() { return server_; }
  EchoHandler& handler() { return handler_; }

 private:
  EchoHandler handler_;
  HttpServer server_;
  std::thread thread_;
};

}  // namespace floorloc
