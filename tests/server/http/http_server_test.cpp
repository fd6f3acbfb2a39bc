// SPDX-License-Identifier: Apache-2.0
#include "server/http/http_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>

#include "tests/server/http/echo_server.h"

// Included after Eigen: httplib.h includes <resolv.h>, whose macro _res is the name of a parameter in Eigen.
#include <httplib.h>

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

HttpLimits SmallLimits() {
  HttpLimits limits;
  limits.max_body_bytes = 100'000;
  limits.max_bodies_bytes = 150'000;
  limits.max_connections = 3;
  return limits;
}

class HttpServerTest : public testing::Test {
 protected:
  HttpServerTest() : server_({"127.0.0.1", 0, SmallLimits()}, handler_), thread_([this] { server_.Serve(); }) {}
  ~HttpServerTest() override { Stop(); }
  void Stop() {
    if (thread_.joinable()) {
      server_.Stop();
      thread_.join();
    }
  }
  httplib::Client MakeClient() { return httplib::Client("127.0.0.1", server_.port()); }
  std::string Exchange(const std::string& text) {
    RawClient client(server_.port());
    client.Send(text);
    client.CloseOutput();
    return client.ReadAll();
  }

  EchoHandler handler_;
  HttpServer server_;
  std::thread thread_;
};

std::string CodeOf(const httplib::Result& result) {
  return result ? nlohmann::json::parse(result->body).value("code", "") : "no answer";
}

TEST_F(HttpServerTest, HandsOverMethodPathAndBody) {
  httplib::Client client = MakeClient();
  EXPECT_EQ(client.Get("/a%20b")->body, "GET /a b ");
  EXPECT_EQ(client.Put("/x", "body", "text/plain")->body, "PUT /x body");
  EXPECT_EQ(client.Delete("/x")->body, "DELETE /x ");
  EXPECT_EQ(client.Post("/p", httplib::MultipartFormDataItems{{"a", "1", "", ""}, {"b", "2", "f", "image/png"}})->body,
            "POST /p [a=1][b=2]");
}

TEST_F(HttpServerTest, KeepsTheConnectionForManyRequests) {
  httplib::Client client = MakeClient();
  client.set_keep_alive(true);
  for (int i = 0; i < 20; ++i) {
    const auto result = client.Get("/again");
    ASSERT_TRUE(result);
    EXPECT_NE(result->get_header_value("Connection"), "close");
  }
  EXPECT_EQ(server_.connections(), 1);
}

TEST_F(HttpServerTest, RefusesBodiesThatAreTooLarge) {
  httplib::Client client = MakeClient();
  const auto announced = client.Post("/x", std::string(100'001, 'x'), "text/plain");
  ASSERT_TRUE(announced);
  EXPECT_EQ(announced->status, 413);
  EXPECT_EQ(CodeOf(announced), "body_too_large");
  EXPECT_EQ(client.Post("/x", std::string(100'000, 'x'), "text/plain")->status, 200);
  const auto parts = client.Post("/x", httplib::MultipartFormDataItems{{"a", std::string(100'001, 'x'), "", ""}});
  EXPECT_EQ(CodeOf(parts), "body_too_large");
}

TEST_F(HttpServerTest, RefusesUnannouncedBodiesThatGrowTooLarge) {
  std::string text = "POST /x HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 30; ++i) {
    text += "1000\r\n" + std::string(0x1000, 'x') + "\r\n";
  }
  const std::string answer = Exchange(text + "0\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(answer, HasSubstr("body_too_large"));
  EXPECT_THAT(answer, HasSubstr("Connection: close"));
}

TEST_F(HttpServerTest, RefusesBodiesBeyondTheMemoryOfAll) {
  RawClient slow(server_.port());
  slow.Send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 90000\r\nExpect: 100-continue\r\n\r\n");
  // When the slow request is told to send its body, its part of the body budget is reserved.
  EXPECT_THAT(slow.ReadSome(), StartsWith("HTTP/1.1 100"));
  std::string answer;
  httplib::Client client = MakeClient();
  for (int i = 0; i < 1000 && answer != "overloaded"; ++i) {
    const auto result = client.Post("/x", std::string(90'000, 'x'), "text/plain");
    answer = result && result->status == 503 ? CodeOf(result) : "";
  }
  EXPECT_EQ(answer, "overloaded");
}

TEST_F(HttpServerTest, RefusesBeforeItReadsTheBody) {
  const std::string answer = Exchange("POST /refused HTTP/1.1\r\nHost: x\r\nContent-Length: 50000\r\n\r\nonly a bit");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(answer, HasSubstr("Connection: close"));
}

TEST_F(HttpServerTest, RefusesBodiesThatEndEarly) {
  EXPECT_THAT(Exchange("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 50\r\n\r\nonly a bit"),
              HasSubstr("malformed_body"));
}

TEST_F(HttpServerTest, ABodyThatNobodyReadsIsNoRequest) {
  const std::string answer =
      Exchange("GET /a HTTP/1.1\r\nHost: x\r\nContent-Length: 28\r\n\r\nGET /smuggled HTTP/1.1\r\n\r\n\r\n");
  EXPECT_THAT(answer, HasSubstr("GET /a"));
  EXPECT_THAT(answer, testing::Not(HasSubstr("smuggled")));
}

TEST_F(HttpServerTest, RefusesWhatIsNotHttp) {
  EXPECT_THAT(Exchange("hello\r\n\r\n"), HasSubstr("malformed_request"));
  EXPECT_THAT(Exchange("GET / HTTP/1.1\r\nHost: x\r\nRange: bytes=x\r\n\r\n"), HasSubstr("invalid_range"));
  EXPECT_EQ(Exchange(std::string(100'000, 'a')).find("200 OK"), std::string::npos);
  EXPECT_EQ(Exchange(std::string(1000, '\0')).find("200 OK"), std::string::npos);
}

TEST_F(HttpServerTest, LongPathsReachTheHandler) {
  httplib::Client client = MakeClient();
  EXPECT_EQ(client.Post("/" + std::string(8000, 'a'), "", "text/plain")->status, 200);
  EXPECT_EQ(client.Post("/a%0Ab", "", "text/plain")->body, "POST /a\nb ");
}

TEST_F(HttpServerTest, AnswersWhatIsInFlightWhenItStops) {
  auto answer = std::async(std::launch::async, [this] {
    RawClient client(server_.port());
    client.Send("GET /wait HTTP/1.1\r\nHost: x\r\n\r\n");
    return client.ReadAll();
  });
  handler_.waiting.get_future().wait();
  server_.Stop();
  handler_.released.set_value();
  thread_.join();
  EXPECT_THAT(answer.get(), HasSubstr("GET /wait"));
}

TEST_F(HttpServerTest, IdleConnectionsDoNotKeepItFromStopping) {
  httplib::Client client = MakeClient();
  client.set_keep_alive(true);
  ASSERT_TRUE(client.Get("/"));
  Stop();
  EXPECT_FALSE(client.Get("/"));
}

TEST_F(HttpServerTest, APortIsTakenOnce) {
  EchoHandler handler;
  EXPECT_THROW(HttpServer({"127.0.0.1", server_.port(), {}}, handler), std::runtime_error);
}

TEST(HttpServerTimeoutTest, SlowRequestsAreDropped) {
  EchoHandler handler;
  HttpLimits limits;
  limits.request_timeout_s = 0.02;
  HttpServer server({"127.0.0.1", 0, limits}, handler);
  std::thread thread([&] { server.Serve(); });
  RawClient client(server.port());
  client.Send("GET / HTTP/1.1\r\nHost");
  EXPECT_EQ(client.ReadAll().find("200 OK"), std::string::npos);
  server.Stop();
  thread.join();
}

}  // namespace
}  // namespace floorloc
