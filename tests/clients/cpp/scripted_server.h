// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <httplib.h>

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace floorloc::client {

/// What a server was asked.
struct Asked {
  std::string method;
  std::string target;
  std::string body;
  std::string deadline;  ///< X-Deadline-Ms
  std::string authorization;
  int remote_port = 0;  ///< tells connections apart
  std::string last_event_id;
};

/// A server that answers as it is told, and 200 {} afterwards.
class ScriptedServer {
 public:
  using Answer = std::function<void(httplib::Response&)>;

  explicit ScriptedServer(std::deque<Answer> script = {}, int port = 0) : script_(std::move(script)) {
    const auto handle = [this](const httplib::Request& request, httplib::Response& response) {
      Handle(request, response);
    };
    server_.Get(".*", handle).Post(".*", handle).Put(".*", handle).Delete(".*", handle);
    port_ = port == 0 ? server_.bind_to_any_port("127.0.0.1") : (server_.bind_to_port("127.0.0.1", port), port);
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) {  // until then Stop() would do nothing
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  ~ScriptedServer() { Stop(); }

  void Stop() {
    if (thread_.joinable()) {
      server_.stop();
      thread_.join();
    }
  }
  int port() const { return port_; }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
  std::vector<Asked> asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

 private:
  void Handle(const httplib::Request& request, httplib::Response& response) {
    Answer answer = [](httplib::Response& ok) { ok.set_content("{}", "application/json"); };
    {
      const std::lock_guard lock(mutex_);
      asked_.push_back({request.method, request.target, request.body, request.get_header_value("X-Deadline-Ms"),
                        request.get_header_value("Authorization"), request.remote_port,
                        request.get_header_value("Last-Event-ID")});
      if (!script_.empty()) {
        answer = std::move(script_.front());
        script_.pop_front();
      }
    }
    answer(response);
  }

  mutable std::mutex mutex_;
  std::deque<Answer> script_;
  std::vector<Asked> asked_;
  httplib::Server server_;
  std::thread thread_;
  int port_ = 0;
};

inline ScriptedServer::Answer Json(const nlohmann::json& body) {
  return [text = body.dump()](httplib::Response& response) { response.set_content(text, "application/json"); };
}

/// A problem of the server; retry_after is left out when it is empty.
inline ScriptedServer::Answer Problem(int status, const std::string& code, const std::string& retry_after = "") {
  return [=](httplib::Response& response) {
    response.status = status;
    response.set_header("X-Request-Id", "r1");
    if (!retry_after.empty()) {
      response.set_header("Retry-After", retry_after);
    }
    const nlohmann::json body = {{"code", code}, {"detail", "Because of " + code + "."}, {"status", status}};
    response.set_content(body.dump(), "application/problem+json");
  };
}

/// A TrackingAnswer that wants the next image after a second or a quarter of a metre.
inline nlohmann::json Tracked() {
  return nlohmann::json::parse(R"({"status": "localized", "epoch": 0, "age_s": 0, "since_fix": null, "odometry": null,
    "next": {"seconds": 1.0, "metres": 0.25}, "message": "used", "messages": ["used"]})");
}

}  // namespace floorloc::client
