// SPDX-License-Identifier: Apache-2.0
#include "server/http/http_server.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

#include "core/geometry/option_check.h"
#include "server/http/address_group.h"
#include "server/http/body_budget.h"
#include "server/http/connection.h"
#include "server/http/connection_table.h"
#include "server/http/listener.h"
#include "server/http/raw_response.h"
#include "server/http/request_loop.h"

namespace floorloc {
namespace {

constexpr std::chrono::milliseconds kAcceptRetry{50};
constexpr std::chrono::milliseconds kAtOnce{1};  // what the socket's buffer takes without waiting

}  // namespace

struct HttpServer::Impl {
  Impl(const HttpServerOptions& server_options, HttpHandler& server_handler)
      : options(server_options),
        handler(server_handler),
        budget(options.limits.max_bodies_bytes),
        context{options.limits, budget, handler},
        table(options.limits),
        stop_event(::eventfd(0, EFD_CLOEXEC)),
        listener(Listen(options.host, options.port)) {
    timeouts.idle = std::chrono::duration<double>(options.limits.idle_timeout_s);
    timeouts.request = std::chrono::duration<double>(options.limits.request_timeout_s);
    timeouts.stop = std::chrono::duration<double>(options.limits.stop_timeout_s);
  }

  bool WaitForConnection() const {
    std::array<pollfd, 2> waiting{pollfd{listener.socket.get(), POLLIN, 0}, pollfd{stop_event.get(), POLLIN, 0}};
    ::poll(waiting.data(), waiting.size(), -1);
    return (waiting[1].revents & POLLIN) == 0;
  }

  void Accept();
  void Run(int socket, std::unique_ptr<ConnectionPlace> place);
  void Reject(int socket);
  void JoinFinished();

  HttpServerOptions options;
  HttpHandler& handler;
  BodyBudget budget;
  ServingContext context;
  ConnectionTable table;
  ConnectionTimeouts timeouts;
  FileDescriptor stop_event;
  Listener listener;
  std::list<std::thread> threads;
  std::mutex mutex;
  std::vector<std::thread::id> finished;  // guarded by mutex
};

// Runs in the accepting thread, so it must not block on the client.
void HttpServer::Impl::Reject(int socket) {
  ConnectionTimeouts at_once;
  at_once.idle = at_once.request = kAtOnce;
  Connection connection(socket, stop_event.get(), at_once);
  connection.DrainInputOnClose();
  WriteLastResponse(handler.Refuse({}, TooManyConnections()), connection);
  connection.Drain();
}

void HttpServer::Impl::Run(int socket, std::unique_ptr<ConnectionPlace> place) {
  ConnectionTimeouts patience = timeouts;
  if (place->reserved()) {
    patience.idle = patience.request = std::chrono::duration<double>(options.limits.reserved_timeout_s);
  }
  Connection connection(socket, stop_event.get(), patience);
  try {
    ServeRequests(connection, *place, context);
  } catch (const std::exception& error) {
    spdlog::error("a connection was dropped: {}", error.what());
  }
  place.reset();  // before the socket is closed, and its number is given to another connection
  const std::lock_guard lock(mutex);
  finished.push_back(std::this_thread::get_id());
}

void HttpServer::Impl::Accept() {
  const int socket = ::accept4(listener.socket.get(), nullptr, nullptr, SOCK_CLOEXEC);
  if (socket < 0) {
    if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      spdlog::warn("cannot accept a connection: {}", std::strerror(errno));
      std::this_thread::sleep_for(kAcceptRetry);
    }
    return;
  }
  std::unique_ptr<ConnectionPlace> place =
      table.Take(socket, AddressGroup(RemoteAddress(socket)), ConnectionTable::Clock::now());
  if (place == nullptr) {
    Reject(socket);
    return;
  }
  try {
    threads.emplace_back([this, socket, place = std::move(place)]() mutable { Run(socket, std::move(place)); });
  } catch (const std::system_error& error) {
    spdlog::warn("cannot start a thread for a connection: {}", error.what());
    Reject(socket);
  }
}

void HttpServer::Impl::JoinFinished() {
  std::vector<std::thread::id> ids;
  {
    const std::lock_guard lock(mutex);
    ids.swap(finished);
  }
  for (const std::thread::id id : ids) {
    const auto it = std::find_if(threads.begin(), threads.end(), [id](const auto& t) { return t.get_id() == id; });
    it->join();
    threads.erase(it);
  }
}

void HttpServerOptions::Check() const {
  RequireOption(port >= 0 && port <= 65535, "port must be 0 (any) to 65535");
  limits.Check();
}

HttpServer::HttpServer(const HttpServerOptions& options, HttpHandler& handler)
    : impl_((options.Check(), std::make_unique<Impl>(options, handler))) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const { return impl_->listener.port; }

int HttpServer::connections() const { return impl_->table.size(); }

void HttpServer::Serve() {
  while (impl_->WaitForConnection()) {
    impl_->Accept();
    impl_->JoinFinished();
  }
  impl_->listener.socket.Reset();
  for (std::thread& thread : impl_->threads) {
    thread.join();
  }
  impl_->threads.clear();
}

void HttpServer::Stop() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(impl_->stop_event.get(), &one, sizeof one);
}

}  // namespace floorloc
