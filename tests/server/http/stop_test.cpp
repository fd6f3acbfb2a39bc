// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <chrono>
#include <list>

#include "tests/server/http/echo_server.h"

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

TEST(StopTest, NoClientDelaysIt) {
  HttpLimits limits;
  limits.stop_timeout_s = 0.1;
  EchoServer server(limits);
  const int port = server.http().port();
  std::list<RawClient> clients;
  for (const char* begin : {"", "GET / HTTP/1.1\r\nHo", "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\nab",
                            "POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nab"}) {
    clients.emplace_back(port).Send(begin);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const auto start = Clock::now();
  server.Stop();
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
  EXPECT_EQ(clients.front().ReadAll(), "");
  for (auto client = std::next(clients.begin()); client != clients.end(); ++client) {
    EXPECT_THAT(client->ReadAll(), testing::HasSubstr("draining"));
  }
}

TEST(StopTest, ARequestThatArrivesInTimeIsAnswered) {
  HttpLimits limits;
  limits.stop_timeout_s = 10.0;
  EchoServer server(limits);
  RawClient client(server.http().port());
  client.Send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 4\r\nExpect: 100-continue\r\n\r\n");
  ASSERT_THAT(client.ReadSome(), testing::StartsWith("HTTP/1.1 100"));
  server.http().Stop();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  client.Send("late");
  EXPECT_THAT(client.ReadAll(), testing::HasSubstr("POST / late"));
}

}  // namespace
}  // namespace floorloc
