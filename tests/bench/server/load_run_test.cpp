// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/load_run.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace floorloc {
namespace {

// A server on loopback that answers each request of each connection with the same bytes; empty: it is silent.
class FixedServer {
 public:
  explicit FixedServer(std::string answer) : answer_(std::move(answer)), listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bind(listener_, reinterpret_cast<sockaddr*>(&address_), sizeof(address_));
    socklen_t size = sizeof(address_);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address_), &size);
    listen(listener_, 16);
    acceptor_ = std::thread([this] {
      for (int client = accept(listener_, nullptr, nullptr); client >= 0;
           client = accept(listener_, nullptr, nullptr)) {
        clients_.emplace_back([this, client] { Serve(client); });
      }
    });
  }
  FixedServer(const FixedServer&) = delete;
  FixedServer& operator=(const FixedServer&) = delete;
  ~FixedServer() {
    shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    close(listener_);
    for (std::thread& client : clients_) {
      client.join();
    }
  }

  int port() const { return ntohs(address_.sin_port); }
  int requests() const { return requests_; }

 private:
  void Serve(int client) {
    std::string received;
    std::array<char, 4096> buffer;
    for (ssize_t n = 0; (n = recv(client, buffer.data(), buffer.size(), 0)) > 0;) {
      received.append(buffer.data(), static_cast<std::size_t>(n));
      if (received.ends_with("END")) {  // of the body
        ++requests_;
        received.clear();
        send(client, answer_.data(), answer_.size(), MSG_NOSIGNAL);
      }
    }
    close(client);
  }

  const std::string answer_;
  sockaddr_in address_{};
  int listener_;
  std::atomic<int> requests_ = 0;
  std::vector<std::thread> clients_;
  std::thread acceptor_;
};

GroupOutcome RunPlan(int port, const std::string& interval_and_repeat) {
  const std::string request = R"({"head": "POST / HTTP/1.1\r\n", "text": "END"})";
  LoadPlan plan;
  ReadLoadPlan(R"({"port": )" + std::to_string(port) + R"(, "seconds": 0.3, "groups": [{"name": "g", )" +
                   interval_and_repeat + R"(, "connections": [{"source": "127.0.0.3", "requests": [)" + request +
                   "]}, {\"requests\": [" + request + "," + request + "]}]}]}",
               &plan);
  return RunLoad(plan).front();
}

const char* const kLocalized = "HTTP/1.1 200 OK\r\nContent-Length: 22\r\n\r\n{\"status\":\"localized\"}";

TEST(RunLoad, SendsEachRequestOnceAndReadsWhatTheServerSays) {
  FixedServer server(kLocalized);
  const GroupOutcome outcome = RunPlan(server.port(), R"("interval_s": 0)");
  EXPECT_EQ(server.requests(), 3);
  ASSERT_EQ(outcome.latencies_s.size(), 1U);
  EXPECT_EQ(outcome.latencies_s.at(200).size(), 3U);
  EXPECT_EQ(outcome.results, (std::map<std::string, int>{{"localized", 3}}));
  EXPECT_EQ(outcome.unanswered, 0);
  EXPECT_EQ(outcome.broken, 0);
}

TEST(RunLoad, KeepsToItsIntervalAndRepeats) {
  FixedServer server("HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\n\r\n");
  const GroupOutcome outcome = RunPlan(server.port(), R"("interval_s": 0.1, "repeat": true)");
  EXPECT_EQ(outcome.latencies_s.at(503).size(), 6U);  // 3 of each connection
}

TEST(RunLoad, CountsWhatASilentServerDoesNotAnswer) {
  FixedServer server("");
  const GroupOutcome outcome = RunPlan(server.port(), R"("interval_s": 0.1, "repeat": true)");
  EXPECT_TRUE(outcome.latencies_s.empty());
  EXPECT_EQ(outcome.unanswered, 6);  // 2 were sent, the others were due
}

TEST(RunLoad, CountsRefusedConnections) {
  int port = 0;
  { port = FixedServer("").port(); }
  const GroupOutcome outcome = RunPlan(port, R"("interval_s": 0)");
  EXPECT_GE(outcome.broken, 2);
  EXPECT_TRUE(outcome.latencies_s.empty());
}

TEST(ReadLoadPlan, NamesWhatIsWrong) {
  LoadPlan plan;
  EXPECT_THROW(ReadLoadPlan(R"({"port": 1, "bodies": ["/no/such/file"], "groups": []})", &plan), std::runtime_error);
  EXPECT_THROW(ReadLoadPlan(R"({"port": 1, "groups": [{"name": "g", "connections": [{"source": "::1"}]}]})", &plan),
               std::runtime_error);
}

}  // namespace
}  // namespace floorloc
