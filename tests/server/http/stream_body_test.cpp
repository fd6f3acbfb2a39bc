// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <thread>

#include "server/http/router.h"
#include "tests/server/http/echo_server.h"

namespace floorloc {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

/// Counts bytes, up to a limit.
class CountingSink : public BodySink {
 public:
  explicit CountingSink(std::size_t limit) : limit_(limit) {}
  void Write(std::string_view bytes) override {
    count += bytes.size();
    if (count > limit_) {
      throw Problem(413, "too_much", "Too much.");
    }
  }
  std::size_t count = 0;

 private:
  std::size_t limit_;
};

/// A server whose call /stream takes 3 MiB, and whose other calls take 1 kB.
class StreamBodyTest : public testing::Test {
 protected:
  StreamBodyTest() {
    Route route{"POST", "/stream", RouteAccess::kAdmin, {}, [](const HttpRequest& request) {
                  const auto& sink = dynamic_cast<const CountingSink&>(*request.sink);
                  return HttpResponse{200, "text/plain", "got " + std::to_string(sink.count), {}};
                }};
    route.receive = [](const HttpRequest&) { return BodyStream{std::make_shared<CountingSink>(3 * kMiB), 3 * kMiB}; };
    router_.Add(route);
    router_.Add({"POST", "/plain", RouteAccess::kWrite, {}, [](const HttpRequest& request) {
                   return HttpResponse{200, "text/plain", "got " + std::to_string(request.body.size()), {}};
                 }});
    const auto switched = [](const HttpRequest&) { return HttpResponse{200, "text/plain", "switched", {}}; };
    router_.Add({"POST", "/switch", RouteAccess::kAdmin, {}, switched});
    router_.Add({"POST", "/json", RouteAccess::kWrite, {"application/json"}, switched});
    server_ = std::make_unique<HttpServer>(HttpServerOptions{"127.0.0.1", 0, Limits()}, router_);
    thread_ = std::thread([this] { server_->Serve(); });
  }
  ~StreamBodyTest() override {
    server_->Stop();
    thread_.join();
  }
  static HttpLimits Limits() {
    HttpLimits limits;
    limits.max_body_bytes = limits.max_bodies_bytes = 1000;
    limits.request_timeout_s = 0.5;
    return limits;
  }
  std::string Exchange(const std::string& text) {
    RawClient client(server_->port());
    std::thread sender([&] { client.Send(text); });
    std::string answer = client.ReadAll();
    sender.join();
    return answer;
  }
  static std::string Head(const std::string& path, const std::string& framing) {
    return "POST " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + framing + "\r\n\r\n";
  }
  static std::string Sized(const std::string& path, std::size_t bytes) {
    return Head(path, "Content-Length: " + std::to_string(bytes)) + std::string(bytes, 'x');
  }

  Metrics metrics_;
  Router router_{{}, metrics_};
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

TEST_F(StreamBodyTest, TakesMoreThanMemoryWould) {
  EXPECT_NE(Exchange(Sized("/stream", 2 * kMiB)).find("got 2097152"), std::string::npos);
  const std::string chunk = "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
  std::string chunks = Head("/stream", "Transfer-Encoding: chunked");
  for (int i = 0; i < 32; ++i) {
    chunks += chunk;
  }
  EXPECT_NE(Exchange(chunks + "0\r\n\r\n").find("got 2097152"), std::string::npos);
  EXPECT_NE(Exchange(Sized("/plain", 2000)).find("body_too_large"), std::string::npos);
  EXPECT_NE(Exchange(Sized("/plain", 500)).find("got 500"), std::string::npos);
}

TEST_F(StreamBodyTest, EndsWhereTheSinkDoes) {
  const std::string chunk = "100000\r\n" + std::string(kMiB, 'x') + "\r\n";
  const std::string answer = Exchange(Head("/stream", "Transfer-Encoding: chunked") + chunk + chunk + chunk + chunk);
  EXPECT_NE(answer.find("too_much"), std::string::npos) << answer;
}

// A MiB may take request_timeout_s, the whole may take longer.
TEST_F(StreamBodyTest, GoesOnAsLongAsSomethingComes) {
  RawClient client(server_->port());
  client.Send(Head("/stream", "Content-Length: " + std::to_string(2 * kMiB + 10)));
  for (int i = 0; i < 2; ++i) {
    client.Send(std::string(kMiB, 'x'));
    std::this_thread::sleep_for(std::chrono::milliseconds(350));
  }
  client.Send("0123456789");
  EXPECT_NE(client.ReadAll().find("got 2097162"), std::string::npos);

  RawClient slow(server_->port());
  slow.Send(Head("/stream", "Content-Length: 1000") + "x");
  EXPECT_NE(slow.ReadAll().find("request_timeout"), std::string::npos);
}

// As curl -X POST sends it.
TEST_F(StreamBodyTest, ACallWithoutABodyNeedsNoLength) {
  const std::string head = "POST /switch HTTP/1.1\r\nHost: x\r\n\r\n";
  const std::string answer = Exchange(head + head + Head("/json", "Content-Type: application/json") + "{}");
  EXPECT_NE(answer.find("switched", answer.find("switched") + 1), std::string::npos) << answer;
  EXPECT_NE(answer.find("length_required"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("malformed_request"), std::string::npos) << answer;  // the body is no next request
}

TEST_F(StreamBodyTest, PagesOfOtherSitesAreRefused) {
  const auto answer = [&](const std::string& origin) {
    return Exchange(Head("/stream", "Content-Length: 0\r\nOrigin: " + origin));
  };
  EXPECT_NE(answer("http://evil.example").find("foreign_origin"), std::string::npos);
  EXPECT_NE(answer("null").find("foreign_origin"), std::string::npos);
  EXPECT_NE(answer("http://x").find("got 0"), std::string::npos);
}

}  // namespace
}  // namespace floorloc
