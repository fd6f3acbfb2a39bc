// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <list>

#include "server/http/address_group.h"
#include "server/http/connection_table.h"
#include "server/http/login_limiter.h"
#include "tests/server/http/echo_server.h"

namespace floorloc {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string Get(int port, const std::string& path, const char* from = "127.0.0.1") {
  RawClient client(port, from);
  client.Send("GET " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  return client.ReadAll();
}

/// Connections in the middle of a request.
class BusyClients {
 public:
  void Add(int port, int count, const char* from = "127.0.0.1") {
    for (int i = 0; i < count; ++i) {
      RawClient& client = clients_.emplace_back(port, from);
      client.Send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\nExpect: 100-continue\r\n\r\n");
      ASSERT_THAT(client.ReadSome(), StartsWith("HTTP/1.1 100"));
    }
  }

 private:
  std::list<RawClient> clients_;
};

HttpLimits FewConnections() {
  HttpLimits limits;
  limits.max_connections = 4;
  limits.max_connections_per_address = 3;
  return limits;
}

TEST(ConnectionLimitsTest, IdleConnectionsMakeRoom) {
  EchoServer server(FewConnections());
  const int port = server.http().port();
  std::list<RawClient> idle;
  for (int i = 0; i < 20; ++i) {
    idle.emplace_back(port);
  }
  EXPECT_THAT(Get(port, "/", "127.0.0.2"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Get(port, "/"), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(idle.front().ReadAll(), "");
}

TEST(ConnectionLimitsTest, AnAddressLeavesPlacesToOthers) {
  EchoServer server(FewConnections());
  const int port = server.http().port();
  BusyClients busy;
  busy.Add(port, 3);
  const std::string answer = Get(port, "/");
  EXPECT_THAT(answer,
              AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("too_many_connections"), HasSubstr("Retry-After: 1")));
  EXPECT_THAT(Get(port, "/livez"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(Get(port, "/", "127.0.0.2"), StartsWith("HTTP/1.1 200"));
}

TEST(ConnectionLimitsTest, HealthChecksAreAnsweredWhenAllPlacesAreTaken) {
  EchoServer server(FewConnections());
  const int port = server.http().port();
  BusyClients busy;
  busy.Add(port, 3);
  busy.Add(port, 1, "127.0.0.2");
  for (const char* from : {"127.0.0.1", "127.0.0.2", "127.0.0.3"}) {
    EXPECT_THAT(Get(port, "/livez", from), StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(Get(port, "/", from), AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("too_many_connections")));
  }
}

TEST(ConnectionLimitsTest, AnIdleHealthCheckHoldsTheReserveForAMoment) {
  HttpLimits limits = FewConnections();
  limits.reserved_connections = 1;
  limits.reserved_timeout_s = 0.05;
  EchoServer server(limits);
  BusyClients busy;
  busy.Add(server.http().port(), 3);
  RawClient idle(server.http().port());
  EXPECT_EQ(idle.ReadAll(), "");
  EXPECT_THAT(Get(server.http().port(), "/livez"), StartsWith("HTTP/1.1 200"));
}

TEST(ConnectionTableTest, RoomIsMadeByThoseWhoHoldMost) {
  HttpLimits limits;
  limits.max_connections = 4;
  limits.max_connections_per_address = 4;
  limits.reserved_connections = 0;
  ConnectionTable table(limits);
  const ConnectionTable::Clock::time_point now{};
  std::list<std::unique_ptr<ConnectionPlace>> places;
  for (const char* address : {"a", "b", "b", "c"}) {
    places.push_back(table.Take(-1, address, now));
    ASSERT_NE(places.back(), nullptr);
  }
  const auto b1 = std::next(places.begin(), 1);
  (*b1)->SetWaiting(false);
  places.push_back(table.Take(-1, "d", now));  // the second of b
  ASSERT_NE(places.back(), nullptr);
  for (const auto& place : places) {
    place->SetWaiting(false);
  }
  EXPECT_EQ(table.Take(-1, "e", now), nullptr);
  (*b1)->SetWaiting(true);
  EXPECT_EQ(table.Take(-1, "a", now) == nullptr, false);  // b has one left, as many as a
  EXPECT_EQ(table.size(), 5);
}

TEST(AddressGroupTest, IsWhatOneClientHas) {
  EXPECT_EQ(AddressGroup("10.0.0.7"), "10.0.0.7");
  EXPECT_EQ(AddressGroup("::ffff:10.0.0.7"), "10.0.0.7");
  EXPECT_EQ(AddressGroup("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(AddressGroup("fe80::1%eth0"), "fe80::/64");
  EXPECT_EQ(AddressGroup(""), "");
}

TEST(LoginLimiterTest, LocksThoseWhoGuess) {
  using Verdict = LoginLimiter::Verdict;
  LoginLimiter limiter(2);
  const LoginLimiter::TimePoint start{};
  EXPECT_EQ(limiter.Judge("fleet", true, start), Verdict::kAllowed);
  for (const char* client : {"guesser", "fleet"}) {
    EXPECT_EQ(limiter.Judge(client, false, start), Verdict::kRefused);
    EXPECT_EQ(limiter.Judge(client, false, start), Verdict::kRefused);
    EXPECT_EQ(limiter.Judge(client, false, start), Verdict::kLocked);
  }
  EXPECT_EQ(limiter.Judge("guesser", true, start), Verdict::kLocked);
  EXPECT_EQ(limiter.Judge("fleet", true, start), Verdict::kAllowed);
  EXPECT_EQ(limiter.Judge("other", true, start), Verdict::kAllowed);
  EXPECT_EQ(limiter.Judge("guesser", true, start + std::chrono::seconds(31)), Verdict::kAllowed);
  LoginLimiter unlimited(0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(unlimited.Judge("guesser", false, start), Verdict::kRefused);
  }
}

}  // namespace
}  // namespace floorloc
