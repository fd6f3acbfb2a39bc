// SPDX-License-Identifier: Apache-2.0
#include "server/http/access_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "server/http/log_scope.h"
#include "server/http/router.h"

namespace floorloc {
namespace {

class AccessLogTest : public testing::Test {
 protected:
  AccessLogTest() {
    router_.Add({"GET", "/v1/maps/{map}", RouteAccess::kRead, {}, [this](const HttpRequest& request) {
                   id_in_handler_ = LogScope::Current() == nullptr ? "" : LogScope::Current()->request_id;
                   if (request.path_parameters.at("map") == "none") {
                     throw Problem(404, "unknown_map", "No.");
                   }
                   return HttpResponse{200, "text/plain", "four", {}};
                 }});
    router_.Add({"GET", "/livez", RouteAccess::kHealth, {}, [](const HttpRequest&) { return HttpResponse{}; }});
    router_.SetAccessLog([this](const AccessRecord& record) { records_.push_back(record); });
  }

  static RouterOptions Options() {
    RouterOptions options;
    options.tokens = AccessTokens("0123456789abcdef");
    return options;
  }
  static HttpRequest Get(const std::string& path, std::map<std::string, std::string> headers = {}) {
    HttpRequest request;
    request.method = "GET";
    request.path = path;
    request.remote_address = "10.0.0.7";
    request.headers = std::move(headers);
    request.trace = StartTrace(request.headers);
    return request;
  }

  Metrics metrics_;
  Router router_{Options(), metrics_};
  std::vector<AccessRecord> records_;
  std::string id_in_handler_;
};

TEST_F(AccessLogTest, EveryAnswerIsARecordOfItsRequest) {
  const HttpResponse response =
      router_.Handle(Get("/v1/maps/hall", {{"x-request-id", "mine"}, {"authorization", "Bearer 0123456789abcdef"}}));
  ASSERT_EQ(records_.size(), 1U);
  const AccessRecord& record = records_.front();
  EXPECT_EQ(record.route, "/v1/maps/{map}");
  EXPECT_EQ(record.status, 200);
  EXPECT_EQ(record.bytes, 4U);
  EXPECT_EQ(record.who, "token");
  EXPECT_EQ(record.problem, "");
  EXPECT_EQ(record.trace.request_id, "mine");
  EXPECT_EQ(response.headers.at("X-Request-Id"), "mine");
  EXPECT_FALSE(response.headers.contains("traceparent"));
  EXPECT_EQ(id_in_handler_, "mine");
  EXPECT_EQ(LogScope::Current(), nullptr);
}

TEST_F(AccessLogTest, RefusalsSayWhyAndHealthChecksAreNoNews) {
  router_.Handle(Get("/v1/maps/none"));
  router_.Admit(Get("/nowhere"));
  router_.Refuse(Get("/v1/maps/hall"), Problem(413, "body_too_large", "No."));
  router_.Handle(Get("/livez"));
  ASSERT_EQ(records_.size(), 3U);
  EXPECT_EQ(records_[0].problem, "unknown_map");
  EXPECT_EQ(records_[1].problem, "not_found");
  EXPECT_EQ(records_[1].route, "unmatched");
  EXPECT_EQ(records_[2].problem, "body_too_large");
}

TEST_F(AccessLogTest, ATraceComesBackWithTheSpanOfTheRequest) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736";
  const HttpResponse response =
      router_.Handle(Get("/v1/maps/none", {{"traceparent", "00-" + trace + "-00f067aa0ba902b7-01"}}));
  ASSERT_EQ(records_.size(), 1U);
  EXPECT_EQ(records_.front().trace.trace_id, trace);
  EXPECT_EQ(response.headers.at("traceparent"), "00-" + trace + "-" + records_.front().trace.span_id + "-01");
}

TEST(AccessFormatTest, ALineIsOneLine) {
  AccessRecord record;
  record.method = "GET";
  record.path = "/a\nb \"c\"";
  record.route = "unmatched";
  record.status = 404;
  record.problem = "not_found";
  record.bytes = 12;
  record.seconds = 0.0123456;
  record.remote = "10.0.0.7";
  record.trace.request_id = "id";
  record.trace.trace_id = "trace";
  EXPECT_EQ(FormatAccessText(record), R"(10.0.0.7 - "GET /a?b?"c"" 404 not_found 12 B 12.3 ms id)");
  const auto json = nlohmann::json::parse("{" + FormatAccessJson(record) + "}");
  EXPECT_EQ(json["path"], "/a?b?\"c\"");
  EXPECT_EQ(json["status"], 404);
  EXPECT_EQ(json["problem"], "not_found");
  EXPECT_EQ(json["duration_ms"], 12.346);
  EXPECT_EQ(json["trace_id"], "trace");
  EXPECT_FALSE(json.contains("who"));
}

}  // namespace
}  // namespace floorloc
