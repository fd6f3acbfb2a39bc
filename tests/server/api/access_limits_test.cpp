// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <sstream>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

ServerConfig WithToken(const TemporaryFolder& folder) {
  ServerConfig config;
  config.token_file = folder.path() / "token";
  std::ofstream(config.token_file) << "0123456789abcdef";
  std::filesystem::permissions(config.token_file, std::filesystem::perms::owner_read);
  return config;
}

TEST(AccessLimitsTest, RefusedLoginsCountAsRequests) {
  const TemporaryFolder folder;
  ServerConfig config = WithToken(folder);
  config.limits.max_requests_per_s = 0.01;
  TestServer server(config);
  ContractClient client(server.port());
  ExpectProblem(client.Delete("/v1/vehicles/a"), 401, "unauthorized");
  ExpectProblem(client.Delete("/v1/vehicles/a"), 429, "rate_limited");
  ExpectProblem(client.Get("/nowhere"), 429, "rate_limited");
  EXPECT_EQ(client.Get("/livez").status, 200);
}

TEST(AccessLimitsTest, GuessesOfTokensAreFew) {
  const TemporaryFolder folder;
  ServerConfig config = WithToken(folder);
  config.limits.max_failed_logins = 3;
  TestServer server(config);
  ContractClient guesser(server.port(), "fedcba9876543210");
  for (int i = 0; i < 3; ++i) {
    ExpectProblem(guesser.Delete("/v1/vehicles/a"), 401, "unauthorized");
  }
  ExpectProblem(guesser.Delete("/v1/vehicles/a"), 429, "too_many_failed_logins");
  ContractClient lucky(server.port(), "0123456789abcdef");
  ExpectProblem(lucky.Delete("/v1/vehicles/a"), 429, "too_many_failed_logins");
  EXPECT_EQ(guesser.Get("/v1/vehicles").status, 200);
}

TEST(RolesTest, AVehiclesTokenIsForItsVehicles) {
  const TemporaryFolder folder;
  ServerConfig config = WithToken(folder);
  std::filesystem::permissions(config.token_file, std::filesystem::perms::owner_all);
  // The tokens are test and secret.
  std::ofstream(config.token_file)
      << "line vehicle 9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08 line-*\n"
      << "office operator 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";
  TestServer server(config);
  ContractClient vehicle(server.port(), "test");
  ContractClient office(server.port(), "secret");
  const std::string body = VehicleBody().dump();
  EXPECT_EQ(vehicle.Put("/v1/vehicles/line-1", body).status, 201);
  ExpectProblem(vehicle.Put("/v1/vehicles/other", body), 403, "forbidden");
  EXPECT_EQ(office.Put("/v1/vehicles/other", body).status, 201);
  ExpectProblem(vehicle.Post("/v1/vehicles/other/odometry", "{}", "application/json"), 403, "forbidden");
  ExpectProblem(vehicle.Post("/v1/vehicles/line-1/odometry", "{}", "application/json"), 422, "invalid_field");
  ExpectProblem(vehicle.Delete("/v1/vehicles/other"), 403, "forbidden");
  EXPECT_EQ(vehicle.Get("/v1/vehicles/other").status, 200);
}

TEST(AuditTest, TheLogSaysWhoChangedWhat) {
  const TemporaryFolder folder;
  std::ostringstream log;
  const auto previous = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("audit", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  {
    TestServer server(WithToken(folder));
    ContractClient client(server.port(), "0123456789abcdef");
    client.Put("/v1/vehicles/a", VehicleBody().dump());
    client.Post("/v1/vehicles/a/odometry", "{}", "application/json");
    client.Delete("/v1/vehicles/b%0Aaudit:%20forged");
  }
  spdlog::set_default_logger(previous);
  EXPECT_THAT(log.str(), testing::HasSubstr("audit: PUT /v1/vehicles/a by token (admin) from 127.0.0.1 -> 201\n"));
  EXPECT_THAT(log.str(), testing::HasSubstr("audit: DELETE /v1/vehicles/b?audit:?forged by token (admin)"));
  EXPECT_THAT(log.str(), testing::Not(testing::HasSubstr("odometry")));
  EXPECT_THAT(log.str(), testing::Not(testing::HasSubstr("0123456789abcdef")));
}

}  // namespace
}  // namespace floorloc
