// SPDX-License-Identifier: Apache-2.0
#include "server/wire/request_trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace floorloc {
namespace {

const std::string kTrace = "4bf92f3577b34da6a3ce929d0e0e4736";

TEST(RequestTraceTest, ATraceIsContinuedWithAnOwnSpan) {
  const RequestTrace trace = StartTrace({{"traceparent", "00-" + kTrace + "-00f067aa0ba902b7-01"}});
  EXPECT_TRUE(trace.continued);
  EXPECT_EQ(trace.trace_id, kTrace);
  EXPECT_NE(trace.span_id, "00f067aa0ba902b7");
  EXPECT_EQ(trace.Traceparent(), "00-" + kTrace + "-" + trace.span_id + "-01");
  EXPECT_EQ(trace.request_id, trace.span_id);
  EXPECT_TRUE(StartTrace({{"traceparent", "cc-" + kTrace + "-00f067aa0ba902b7-01-more"}}).continued) << "later version";
}

TEST(RequestTraceTest, WhatIsNoTraceparentIsIgnored) {
  for (const std::string& text : std::vector<std::string>{
           std::string(), "00-" + kTrace + "-00f067aa0ba902b7", "00-" + kTrace + "-00f067aa0ba902b7-0",
           "ff-" + kTrace + "-00f067aa0ba902b7-01", "00-" + kTrace + "-00f067aa0ba902b7-01-more",
           "00-" + kTrace + "-0000000000000000-01", "00-" + std::string(32, '0') + "-00f067aa0ba902b7-01",
           "00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01", "0g-" + kTrace + "-00f067aa0ba902b7-01",
           "00_" + kTrace + "-00f067aa0ba902b7-01"}) {
    const RequestTrace trace = StartTrace({{"traceparent", text}});
    EXPECT_FALSE(trace.continued) << text;
    EXPECT_NE(trace.trace_id, kTrace) << text;
    EXPECT_EQ(trace.trace_id.size(), 32U);
    EXPECT_EQ(trace.flags, "00");
  }
}

TEST(RequestTraceTest, RequestsHaveDifferentIdsOrTheirOwn) {
  EXPECT_NE(StartTrace({}).request_id, StartTrace({}).request_id);
  EXPECT_NE(StartTrace({}).trace_id, StartTrace({}).trace_id);
  EXPECT_EQ(StartTrace({{"x-request-id", "agv7:frame/12+b=_.-"}}).request_id, "agv7:frame/12+b=_.-");
  for (const std::string& bad : std::vector<std::string>{"", "a b", "a\nb", "\"", std::string(129, 'a')}) {
    const RequestTrace trace = StartTrace({{"x-request-id", bad}});
    EXPECT_EQ(trace.request_id, trace.span_id) << bad;
  }
}

}  // namespace
}  // namespace floorloc
