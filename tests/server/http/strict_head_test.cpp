// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "tests/server/http/echo_server.h"

namespace floorloc {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kSmuggled = "GET /smuggled HTTP/1.1\r\nHost: x\r\n\r\n";

std::string Post(const std::string& headers, const std::string& body = "{}") {
  return "POST /first HTTP/1.1\r\nHost: x\r\n" + headers + "\r\n" + body;
}
std::string Get(const std::string& headers) { return "GET /first HTTP/1.1\r\n" + headers + "\r\n"; }

/// One answer, with this status and code, after which the connection is closed whatever follows.
auto IsRefused(int status, const std::string& code) {
  return AllOf(StartsWith("HTTP/1.1 " + std::to_string(status) + " "), HasSubstr("application/problem+json"),
               HasSubstr("\"code\":\"" + code + "\""), HasSubstr("Connection: close"), Not(HasSubstr("smuggled")));
}

class StrictHeadTest : public testing::Test {
 protected:
  std::string Exchange(const std::string& text) { return server_.Exchange(text); }
  void ExpectRefused(const std::string& request, int status, const std::string& code) {
    EXPECT_THAT(Exchange(request + kSmuggled), IsRefused(status, code)) << request;
  }
  EchoServer server_;
};

TEST_F(StrictHeadTest, TheEndOfARequestIsUnambiguous) {
  ExpectRefused(Post("Content-Length: 4\r\nTransfer-Encoding: chunked\r\n", "0\r\n\r\n"), 400, "malformed_request");
  ExpectRefused(Post("Transfer-Encoding: chunked\r\nContent-Length: 4\r\n", "0\r\n\r\n"), 400, "malformed_request");
  ExpectRefused(Post("Content-Length: 2\r\nContent-Length: 50\r\n"), 400, "malformed_request");
  for (const char* length : {"", "+2", "-1", "0x2", "2x", "2, 2", "2 2", "\xC2\xB2"}) {
    ExpectRefused(Post(std::string("Content-Length: ") + length + "\r\n"), 400, "malformed_request");
  }
  ExpectRefused(Post("Content-Length: 99999999999999999999\r\n"), 413, "body_too_large");
  ExpectRefused(Post("Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"), 400, "malformed_request");
  for (const char* coding : {"gzip, chunked", "chunked, gzip", "xchunked", "identity", "\"chunked\""}) {
    ExpectRefused(Post(std::string("Transfer-Encoding: ") + coding + "\r\n"), 501, "unknown_transfer_coding");
  }
  ExpectRefused("POST /first HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n", 400, "malformed_request");
}

TEST_F(StrictHeadTest, HeadersAreWrittenAsTheyShouldBe) {
  for (const char* header :
       {"Content-Length : 2", "X: a\r\n b", " X: a", "X", ": a", "X(: a", "X: a\rb", "X: \x01", "X: \x7F", "Host: y",
        "X: a\nY: b", "Authorization: a\r\nAuthorization: b", "Content-Type: a/b\r\nContent-Type: c/d"}) {
    ExpectRefused(Get(std::string("Host: x\r\n") + header + "\r\n"), 400, "malformed_request");
  }
  ExpectRefused(Get(std::string("Host: x\r\nX: a\0b\r\n", 16)), 400, "malformed_request");
  ExpectRefused(Get(std::string("Host: x\r\nX\0: b\r\n", 16)), 400, "malformed_request");
  ExpectRefused(Get(""), 400, "malformed_request");
  ExpectRefused(Get("Host: x/y\r\n"), 400, "malformed_request");
  ExpectRefused(Get("Host: x\r\nExpect: tea\r\n"), 417, "expectation_failed");
  EXPECT_THAT(Exchange("GET / HTTP/1.1\nHost: x\n\n"), IsRefused(400, "malformed_request"));
}

TEST_F(StrictHeadTest, RequestLinesAreWrittenAsTheyShouldBe) {
  for (const char* line : {"GET  / HTTP/1.1", "GET / HTTP/1.1 ", "GET /a b HTTP/1.1", "GET /\xC3\xA4 HTTP/1.1", "GET /",
                           "/ HTTP/1.1", "G(T / HTTP/1.1", "GET / FTP/1.1"}) {
    ExpectRefused(std::string(line) + "\r\nHost: x\r\n\r\n", 400, "malformed_request");
  }
  for (const char* method : {"BREW", "get", "CONNECT"}) {
    ExpectRefused(std::string(method) + " / HTTP/1.1\r\nHost: x\r\n\r\n", 501, "unknown_method");
  }
  ExpectRefused("GET / HTTP/2.0\r\nHost: x\r\n\r\n", 505, "unsupported_http_version");
  // The first bytes of TLS: nobody waits for the end of that line.
  EXPECT_THAT(Exchange(std::string("\x16\x03\x01\x02\x00\x01", 6)), IsRefused(400, "malformed_request"));
}

TEST_F(StrictHeadTest, HeadsAreOfLimitedSize) {
  ExpectRefused("GET /" + std::string(9000, 'a') + " HTTP/1.1\r\nHost: x\r\n\r\n", 414, "uri_too_long");
  ExpectRefused(std::string(40'000, 'a'), 414, "uri_too_long");
  ExpectRefused(Get("Host: x\r\nX: " + std::string(9000, 'a') + "\r\n"), 431, "head_too_large");
  std::string many;
  for (int i = 0; i < 100; ++i) {
    many += "X: a\r\n";
  }
  ExpectRefused(Get("Host: x\r\n" + many), 431, "head_too_large");
  ExpectRefused(Get("Host: x\r\n" + std::string(4, 'X') + ": " + std::string(8000, 'a') + "\r\n" + std::string("Y: ") +
                    std::string(8000, 'a') + "\r\nZ: " + std::string(8000, 'a') + "\r\nA: " + std::string(8000, 'a') +
                    "\r\nB: " + std::string(1000, 'a') + "\r\n"),
                431, "head_too_large");
}

TEST_F(StrictHeadTest, ChunksAreFramedAsTheyShouldBe) {
  const std::string chunked = "Transfer-Encoding: Chunked\r\n";
  EXPECT_THAT(Exchange(Post(chunked, "2\r\nab\r\n00A;x=y\r\n0123456789\r\n0\r\n\r\n") + kSmuggled),
              AllOf(HasSubstr("POST /first ab0123456789"), HasSubstr("GET /smuggled")));
  for (const char* body :
       {"0x2\r\nab\r\n0\r\n\r\n", " 2\r\nab\r\n0\r\n\r\n", "+2\r\nab\r\n0\r\n\r\n", "2\nab\r\n0\r\n\r\n",
        "2\r\nabXX0\r\n\r\n", "2\r\nab\r\n0\r\nX: y\r\n\r\n", "\r\nab", "2 \r\nab\r\n0\r\n\r\n",
        "000000000000000000000000000000002\r\nab\r\n0\r\n\r\n", "2;a\nb\r\nab\r\n0\r\n\r\n"}) {
    EXPECT_THAT(Exchange(Post(chunked, body) + kSmuggled), IsRefused(400, "malformed_body")) << body;
  }
}

TEST_F(StrictHeadTest, WhatIsAllowedIsServed) {
  EXPECT_THAT(Exchange("\r\n" + Get("host:x:80\r\nX:\t\xC3\xA4 \r\nY:\r\n")), HasSubstr("200 OK"));
  EXPECT_THAT(Exchange("GET / HTTP/1.0\r\n\r\n"), AllOf(HasSubstr("200 OK"), HasSubstr("Connection: close")));
  EXPECT_THAT(Exchange(Get("Host: [::1]:80\r\nConnection: x, Close\r\n") + kSmuggled),
              AllOf(HasSubstr("200 OK"), HasSubstr("Connection: close"), Not(HasSubstr("smuggled"))));
  EXPECT_THAT(Exchange(Post("Content-Length: 2\r\n") + Get("Host: x\r\n")),
              AllOf(HasSubstr("POST /first {}"), HasSubstr("GET /first")));
}

TEST_F(StrictHeadTest, ARefusedRequestIsNotToldToSendItsBody) {
  const std::string answer =
      Exchange("POST /refused HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 401"));
}

TEST(SlowRequestTest, IsAnswered408) {
  HttpLimits limits;
  limits.request_timeout_s = 0.05;
  EchoServer server(limits);
  for (const char* begin : {"GET / HTTP/1.1\r\nHost", "POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nab"}) {
    RawClient client(server.http().port());
    client.Send(begin);
    EXPECT_THAT(client.ReadAll(), IsRefused(408, "request_timeout")) << begin;
  }
}

}  // namespace
}  // namespace floorloc
