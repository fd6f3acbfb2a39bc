// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/http_response.h"

#include <gtest/gtest.h>

#include <string>

namespace floorloc {
namespace {

using Progress = HttpResponse::Progress;

TEST(HttpResponse, IsWholeWithItsLastByteWhereverItIsCut) {
  const std::string text = "HTTP/1.1 503 Service Unavailable\r\nContent-length:  5 \r\nConnection: Close\r\n\r\nhello";
  for (std::size_t cut = 1; cut < text.size(); ++cut) {
    HttpResponse response;
    ASSERT_EQ(response.Add(text.substr(0, cut)), Progress::kIncomplete) << cut;
    ASSERT_EQ(response.Add(text.substr(cut)), Progress::kWhole) << cut;
    EXPECT_EQ(response.status(), 503);
    EXPECT_EQ(response.body(), "hello");
    EXPECT_TRUE(response.closes());
  }
}

TEST(HttpResponse, MayHaveNoBody) {
  HttpResponse response;
  EXPECT_EQ(response.Add("HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n"), Progress::kWhole);
  EXPECT_EQ(response.body(), "");
  EXPECT_FALSE(response.closes());
}

TEST(HttpResponse, WithoutALengthOrStatusIsMalformed) {
  for (const char* text :
       {"HTTP/1.1 200 OK\r\nA: b\r\n\r\n", "HTTP/1.1 2x0 OK\r\nContent-Length: 0\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n", "HTTP/1.1 200 OK\r\nno colon\r\n\r\n", "\r\n\r\n"}) {
    HttpResponse response;
    EXPECT_EQ(response.Add(text), Progress::kMalformed) << text;
  }
}

}  // namespace
}  // namespace floorloc
