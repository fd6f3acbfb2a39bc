// SPDX-License-Identifier: Apache-2.0
#include <future>
#include <string>
#include <vector>

#include "tests/server/fixture/pool_blocker.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

const char* const kLocalize = "/v1/maps/hall/localize";

TEST(OverloadTest, AFullQueueIsAnsweredWith503) {
  ServerConfig config = PatientConfig();  // the second job must outwait the request
  config.threads = 1;
  config.queue_length = 1;
  TestServer server(config);
  ContractClient client(server.port());
  ASSERT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);

  ComputePool& pool = server.app().state().pool;
  PoolBlocker first(pool);
  auto second = pool.Submit(JobLabel(), [] {});
  const auto response = client.Post(std::string(kLocalize) + "?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg");
  first.Release();
  ExpectProblem(response, 503, "queue_full");
  EXPECT_EQ(response.get_header_value("Retry-After"), "1");
  second->get();
  EXPECT_EQ(client.Post(std::string(kLocalize) + "?vehicle=a", SharedMaps().KnownJpeg(), "image/jpeg").status, 200);
}

// Whoever has many images waiting is refused before the body is read; another address is not.
TEST(OverloadTest, AnAnswerThatWouldComeTooLateIsRefusedAtOnce) {
  ServerConfig config = PatientConfig();
  config.threads = 1;
  config.deadline_ms = 40.0;
  TestServer server(config);
  ContractClient client(server.port());
  ASSERT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);

  ComputePool& pool = server.app().state().pool;
  PoolBlocker first(pool, {"address/127.0.0.1"});
  std::vector<std::future<void>> jobs;
  for (int i = 0; i < 20; ++i) {
    jobs.push_back(*pool.Submit({"address/127.0.0.1"}, [] {}));
  }
  const std::string path = std::string(kLocalize) + "?vehicle=a";
  const auto late = client.Post(path, SharedMaps().KnownJpeg(), "image/jpeg");
  ExpectProblem(late, 503, "deadline");
  EXPECT_GE(std::stoi(late.get_header_value("Retry-After")), 1);
  ExpectProblem(client.Post(path, SharedMaps().KnownJpeg(), "image/jpeg", {{"X-Deadline-Ms", "soon"}}), 400,
                "invalid_parameter");
  EXPECT_LT(pool.ExpectedTime({"vehicle/b", WorkClass::kTracking}).count(),
            0.5 * pool.ExpectedTime({"address/127.0.0.1"}).count());
  first.Release();
  for (std::future<void>& job : jobs) {
    job.get();
  }
  EXPECT_EQ(client.Post(path, SharedMaps().KnownJpeg(), "image/jpeg").status, 200);
}

TEST(OverloadTest, WorkThatWaitedTooLongIsAnsweredWith503) {
  ServerConfig config;
  config.queue_timeout_s = 1e-9;
  TestServer server(config);
  ContractClient client(server.port());
  ExpectProblem(client.Put("/v1/vehicles/a", VehicleBody().dump()), 503, "queue_timeout");
}

TEST(OverloadTest, ANewerImageReplacesTheOneThatWaits) {
  ServerConfig config = PatientConfig();
  config.threads = 1;
  TestServer server(config);
  ContractClient client(server.port());
  ASSERT_EQ(client.Put("/v1/vehicles/a", VehicleBody().dump()).status, 201);
  ComputePool& pool = server.app().state().pool;
  PoolBlocker blocker(pool);
  const auto post = [&](const std::string& stamp) {
    return std::async(std::launch::async, [&server, stamp] {
      ContractClient robot(server.port());
      return robot.Post("/v1/vehicles/a/frames?stamp=" + stamp, SharedMaps().KnownJpeg(), "image/jpeg");
    });
  };
  auto older = post("100.0");
  while (pool.QueueDepth() == 0) {
    std::this_thread::yield();
  }
  auto newer = post("100.2");
  ExpectProblem(older.get(), 503, "replaced");
  blocker.Release();
  const httplib::Response answer = newer.get();
  ASSERT_EQ(answer.status, 200);
  EXPECT_EQ(Json(answer)["status"], "localized");
  EXPECT_GE(Json(answer)["timing_ms"]["fusion"].get<double>(), 0.0);
}

}  // namespace
}  // namespace floorloc
