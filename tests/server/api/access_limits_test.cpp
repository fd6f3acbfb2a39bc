// SPDX-License-Identifier: Apache-2.0
#include <fstream>

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

}  // namespace
}  // namespace floorloc
