// SPDX-License-Identifier: Apache-2.0
#include "server/config/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/io/input_error.h"
#include "server/config/config_json.h"
#include "server/http/access.h"
#include "server/wire/strict_json.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ConfigTest, ReadsEveryKey) {
  const ServerConfig config = ParseServerConfig(R"({
    "threads": 3, "queue_length": 7, "queue_timeout_s": 0.5, "deadline_ms": 120, "drain_s": 2, "open": true, "protect_reads": true,
    "log_level": "warning", "log_format": "json", "access_log": true, "token_file": "token", "localizer": {"max_p_wrong": 1e-6},
    "limits": {"max_body_bytes": 10, "max_bodies_bytes": 20, "max_image_pixels": 30, "max_rectifier_bytes": 40, "max_kept_frame_bytes": 0,
               "max_connections": 50, "max_connections_per_address": 51, "reserved_connections": 52,
               "max_failed_logins": 53, "max_vehicles": 60, "vehicle_timeout_s": 65, "stale_after_s": 66, "max_requests_per_s": 70.5, "idle_timeout_s": 80,
               "request_timeout_s": 90}})");
  EXPECT_EQ(config.threads, 3);
  EXPECT_EQ(config.queue_length, 7);
  EXPECT_EQ(config.queue_timeout_s, 0.5);
  EXPECT_EQ(config.deadline_ms, 120.0);
  EXPECT_EQ(config.drain_s, 2.0);
  EXPECT_TRUE(config.open);
  EXPECT_TRUE(config.protect_reads);
  EXPECT_EQ(config.log_level, "warning");
  EXPECT_TRUE(config.json_log);
  EXPECT_TRUE(config.access_log);
  EXPECT_EQ(config.token_file, "token");
  EXPECT_EQ(config.localizer.registration.max_p_wrong, 1e-6);
  EXPECT_EQ(config.limits.http.max_body_bytes, 10U);
  EXPECT_EQ(config.limits.http.max_bodies_bytes, 20U);
  EXPECT_EQ(config.limits.max_image_pixels, 30);
  EXPECT_EQ(config.limits.max_rectifier_bytes, 40U);
  EXPECT_EQ(config.limits.max_kept_frame_bytes, 0U);
  EXPECT_EQ(config.limits.http.max_connections, 50);
  EXPECT_EQ(config.limits.http.max_connections_per_address, 51);
  EXPECT_EQ(config.limits.http.reserved_connections, 52);
  EXPECT_EQ(config.limits.max_failed_logins, 53);
  EXPECT_EQ(config.limits.max_vehicles, 60);
  EXPECT_EQ(config.limits.vehicle_timeout_s, 65.0);
  EXPECT_EQ(config.limits.stale_after_s, 66.0);
  EXPECT_EQ(config.limits.max_requests_per_s, 70.5);
  EXPECT_EQ(config.limits.http.idle_timeout_s, 80.0);
  EXPECT_EQ(config.limits.http.request_timeout_s, 90.0);
}

TEST(ConfigTest, ZeroThreadsAreOnePerCore) { EXPECT_EQ(ParseServerConfig(R"({"threads":0})").threads, 0); }

TEST(ConfigTest, NamesWhatIsWrong) {
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {R"({"thread":1})", "thread"},
           {R"({"limits":{"max_body":1}})", "limits.max_body"},
           {R"({"limits":{"max_body_bytes":0}})", "limits.max_body_bytes"},
           {R"({"limits":{"max_body_bytes":1.5}})", "limits.max_body_bytes"},
           {R"({"limits":{"max_body_bytes":9000000000}})", "limits.max_bodies_bytes"},
           {R"({"localizer":{"max_p_wrong":2}})", "localizer.max_p_wrong"},
           {R"({"log_level":"loud"})", "log_level"},
           {R"({"log_format":"xml"})", "log_format"},
           {R"({"open":1})", "open"},
           {R"({"threads":18446744073709551615})", "threads"},
           {R"({"threads":-1})", "threads must be a whole number from 0 to 256"},
           {"[]", "object"},
           {"{", "JSON"}}) {
    SCOPED_TRACE(text);
    EXPECT_THAT([&text = text] { ParseServerConfig(text); }, ThrowsMessage<JsonError>(HasSubstr(named)));
  }
}

TEST(ConfigTest, FilesAreNamedInErrorsAndTokensLieBesideThem) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "server.json";
  EXPECT_THAT([&] { ReadServerConfig(file); }, ThrowsMessage<InputError>(HasSubstr("server.json")));
  std::ofstream(file) << R"({"token_file":"secret"})";
  EXPECT_EQ(ReadServerConfig(file).token_file, folder.path() / "secret");
  std::ofstream(file) << R"({"nonsense":1})";
  EXPECT_THAT([&] { ReadServerConfig(file); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("server.json"), HasSubstr("nonsense"))));
}

TEST(ConfigTest, ReadsListenAddresses) {
  ServerConfig config;
  SetListenAddress("[::1]:9000", config);
  EXPECT_EQ(config.host, "::1");
  EXPECT_EQ(config.port, 9000);
  EXPECT_TRUE(config.IsLoopback());
  SetListenAddress("0.0.0.0:0", config);
  EXPECT_FALSE(config.IsLoopback());
  for (const char* wrong : {"", "8080", "localhost", "localhost:", ":80", "a:b", "a:-1", "a:70000", "a:1x"}) {
    EXPECT_THROW(SetListenAddress(wrong, config), std::invalid_argument) << wrong;
  }
}

TEST(ConfigTest, IsNotOpenToTheWorldByAccident) {
  ServerConfig config;
  EXPECT_NO_THROW(config.Check());
  config.host = "0.0.0.0";
  EXPECT_THROW(config.Check(), std::invalid_argument);
  config.open = true;
  EXPECT_NO_THROW(config.Check());
  config.open = false;
  config.token_file = "token";
  EXPECT_NO_THROW(config.Check());
  config.token_file.clear();
  config.host = "127.0.0.1";
  config.protect_reads = true;
  EXPECT_THROW(config.Check(), std::invalid_argument);
}

TEST(AccessTokenTest, ComparesTheWholeToken) {
  const AccessTokens token("0123456789abcdef");
  EXPECT_NE(token.Find("Bearer 0123456789abcdef"), nullptr);
  for (const char* wrong : {"", "Bearer ", "0123456789abcdef", "Bearer 0123456789abcde", "Bearer 0123456789abcdeg",
                            "Bearer 0123456789abcdef0123456789abcdef", "bearer 0123456789abcdef"}) {
    EXPECT_EQ(token.Find(wrong), nullptr) << wrong;
  }
  EXPECT_TRUE(AccessTokens().empty());
}

TEST(AccessTokenTest, TheFileBelongsToItsOwnerOnly) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "token";
  EXPECT_THROW(ReadTokenFile(file), InputError);
  const auto write = [&](const std::string& text) {
    std::ofstream(file) << text;
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  };
  write("0123456789abcdef\n");
  EXPECT_NE(ReadTokenFile(file).Find("Bearer 0123456789abcdef"), nullptr);
  std::filesystem::permissions(file, std::filesystem::perms::group_read, std::filesystem::perm_options::add);
  EXPECT_THROW(ReadTokenFile(file), InputError);
  write("short");
  EXPECT_THROW(ReadTokenFile(file), InputError);
  write("0123456789 abcdef");
  EXPECT_THROW(ReadTokenFile(file), InputError);
}

class TokenLinesTest : public testing::Test {
 protected:
  AccessTokens Read(const std::string& text) {
    const auto file = folder_.path() / "tokens";
    std::ofstream(file) << text;
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    return ReadTokenFile(file);
  }
  TemporaryFolder folder_;
};

// printf %s test | sha256sum; printf %s secret | sha256sum
const std::string kHashOfTest = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08";
const std::string kHashOfSecret = "2BB80D537B1DA3E38BD30361AA855686BDE0EACD7162FEF6A25FE97BF527A25B";

TEST_F(TokenLinesTest, TokensHaveNamesRolesAndIds) {
  const AccessTokens tokens =
      Read("# comment\n\nline-3 vehicle " + kHashOfTest + " agv7,line3-*\r\noffice  operator\t" + kHashOfSecret + "\n");
  const Principal* vehicle = tokens.Find("Bearer test");
  const Principal* office = tokens.Find("Bearer secret");
  ASSERT_TRUE(vehicle != nullptr && office != nullptr);
  EXPECT_EQ(tokens.Find("Bearer " + kHashOfTest), nullptr);
  EXPECT_EQ(vehicle->name, "line-3");
  EXPECT_EQ(office->role, Role::kOperator);
  for (const char* own : {"agv7", "line3-", "line3-a"}) {
    EXPECT_TRUE(vehicle->MayChangeVehicle(own)) << own;
  }
  for (const char* other : {"agv70", "agv", "line3", "", "LINE3-a"}) {
    EXPECT_FALSE(vehicle->MayChangeVehicle(other)) << other;
  }
  EXPECT_TRUE(office->MayChangeVehicle("anything"));
}

TEST_F(TokenLinesTest, BadLinesAreNamed) {
  for (const auto& [line, named] :
       std::vector<std::pair<std::string, std::string>>{{"office operator abc", "NAME ROLE SHA256"},
                                                        {"office operator", "NAME ROLE SHA256"},
                                                        {"office operator " + kHashOfTest + " a b", "NAME ROLE SHA256"},
                                                        {"office boss " + kHashOfTest, "vehicle, operator or admin"},
                                                        {"office/1 admin " + kHashOfTest, "name"},
                                                        {"v vehicle " + kHashOfTest, "ids"},
                                                        {"v vehicle " + kHashOfTest + " a,,b", "ids"},
                                                        {"v vehicle " + kHashOfTest + " a*b", "ids"},
                                                        {"v admin " + kHashOfTest + " a", "ids"},
                                                        {"first admin " + kHashOfTest, "earlier line"},
                                                        {"other admin " + kHashOfSecret, "earlier line"}}) {
    const std::string text = "first admin " + kHashOfSecret + "\n" + line + "\n";
    EXPECT_THAT([&] { Read(text); }, ThrowsMessage<InputError>(testing::AllOf(HasSubstr(":2: "), HasSubstr(named))))
        << line;
  }
  EXPECT_THROW(Read("# nothing\n# at all\n"), InputError);
}

}  // namespace
}  // namespace floorloc
