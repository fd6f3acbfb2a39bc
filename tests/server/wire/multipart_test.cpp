// SPDX-License-Identifier: Apache-2.0
#include "server/wire/multipart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/wire/problem.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string Names(const std::vector<HttpPart>& parts) {
  std::string text;
  for (const HttpPart& part : parts) {
    text += "[" + part.name + "|" + part.content_type + "|" + part.content + "]";
  }
  return text;
}

std::string Parse(const std::string& body, const std::string& type = "multipart/form-data; boundary=b") {
  return Names(ParseMultipart(body, type));
}

TEST(MultipartTest, ReadsWhatClientsSend) {
  // .NET's HttpClient: a quoted boundary, names without quotes, the type before the disposition.
  EXPECT_EQ(Parse("--1-2\r\nContent-Type: image/jpeg\r\nContent-Disposition: form-data; name=image; filename=a.jpg; "
                  "filename*=utf-8''a.jpg\r\n\r\n\xFF\xD8\r\n\r\n--1-2\r\nContent-Disposition: form-data; "
                  "name=request\r\n\r\n{}"
                  "\r\n--1-2--\r\n",
                  "multipart/form-data; boundary=\"1-2\""),
            "[image|image/jpeg|\xFF\xD8\r\n][request||{}]");
  EXPECT_EQ(Parse("--b\r\ncontent-disposition:Form-Data;FILENAME=\"x\\\"; name=y\" ; Name=\"a b\"\r\n\r\n\r\n--b--",
                  "Multipart/Form-Data; charset=utf-8; BOUNDARY=b"),
            "[a b||]");
  EXPECT_EQ(
      Parse("preamble\r\n--=_1/2 \t\r\nContent-Disposition: form-data; name=a\r\n\r\n-- \r\n--\r\n--=_1/2--epilogue",
            "multipart/form-data; boundary==_1/2"),
      "[a||-- \r\n--]");
  EXPECT_EQ(Parse("--b--\r\n"), "");
}

TEST(MultipartTest, RefusesWhatIsMalformed) {
  const std::string disposition = "Content-Disposition: form-data; name=a\r\n";
  const std::string part = "--b\r\n" + disposition + "\r\nx\r\n";
  for (const std::string& body :
       {std::string(), std::string("--c--"), std::string("--b"), part, part + "--b", part + "--bc--",
        "--b\r\n" + disposition + "x\r\n--b--", std::string("--b\r\n\r\nx\r\n--b--"),
        "--b\n" + disposition + "\nx\n--b--", "--b\r\n" + disposition + disposition + "\r\nx\r\n--b--",
        std::string("--b\r\nX: y\r\n\r\nx\r\n--b--"),
        std::string("--b\r\nContent-Disposition: attachment; name=a\r\n\r\nx\r\n--b--"),
        std::string("--b\r\nContent-Disposition: form-data; name=\"a\r\n\r\nx\r\n--b--"),
        std::string("--b\r\nContent-Disposition: form-data; name=a; name=b\r\n\r\nx\r\n--b--")}) {
    EXPECT_THAT([&] { Parse(body); }, ThrowsMessage<Problem>(HasSubstr("multipart/form-data body is malformed")))
        << body;
  }
  for (const char* type : {"multipart/form-data", "multipart/form-data; boundary=", "multipart/form-data; boundary=\"",
                           "multipart/form-data; boundary=b; boundary=c", "multipart/form-data; boundary=b x"}) {
    EXPECT_THAT([&] { Parse(part + "--b--", type); }, ThrowsMessage<Problem>(HasSubstr("boundary"))) << type;
  }
  EXPECT_THROW(Parse(part, "multipart/form-data; boundary=" + std::string(71, 'b')), Problem);
}

TEST(MultipartTest, HasFewParts) {
  std::string body;
  for (int i = 0; i < 17; ++i) {
    body += "--b\r\nContent-Disposition: form-data; name=a\r\n\r\n\r\n";
  }
  EXPECT_THAT([&] { Parse(body + "--b--"); }, ThrowsMessage<Problem>(HasSubstr("more than 16 parts")));
}

}  // namespace
}  // namespace floorloc
