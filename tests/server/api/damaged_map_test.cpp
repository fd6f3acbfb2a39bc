// SPDX-License-Identifier: Apache-2.0
#include "server/api/map_json.h"
#include "tests/core/map/map_damages.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

class DamagedMapTest : public ::testing::Test {
 protected:
  void Damage(const std::string& sql) const {
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", file_,
                               std::filesystem::copy_options::overwrite_existing);
    testing_map::RunSql(file_, sql);
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "hall.floormap";
};

TEST_F(DamagedMapTest, IsServedWholeOrListedWithItsReason) {
  for (const auto& damages : {testing_map::FatalDamages(), testing_map::OtherDamages()}) {
    for (const std::string& damage : damages) {
      Damage(damage);
      const auto map = LoadMap(file_, LocalizerOptions());
      const json summary = json::parse(FormatMap(*map));
      if (map->ready()) {
        EXPECT_EQ(summary["status"], "ready") << damage;
        EXPECT_TRUE(json::parse(FormatReport(*map)).is_object()) << damage;
        continue;
      }
      EXPECT_EQ(summary["status"], "error") << damage;
      EXPECT_EQ(summary["code"], "map_damaged") << damage;
      EXPECT_THAT(map->error, HasSubstr("restore it from a copy or build it again")) << damage;
      EXPECT_THAT(map->error, Not(AnyOf(HasSubstr("\n"), HasSubstr(folder_.path().string())))) << damage;
    }
  }
}

// The map stays damaged until it is replaced, so there is no Retry-After.
TEST_F(DamagedMapTest, IsNoReasonToTryAgainSoon) {
  Damage("UPDATE frame SET survey = 1000000");
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  const auto response = client.Get("/v1/maps/hall/report");
  ExpectProblem(response, 500, "map_damaged");
  EXPECT_FALSE(response.has_header("Retry-After"));
  EXPECT_THAT(response.body, HasSubstr("frame 0: survey is 1000000"));
  const json listed = Json(client.Get("/v1/maps"))["maps"][0];
  EXPECT_EQ(listed["code"], "map_damaged");
  EXPECT_THAT(listed["error"].get<std::string>(), HasSubstr("frame 0: survey is 1000000"));
  const auto ready = client.Get("/readyz");
  ExpectProblem(ready, 503, "no_maps");
  EXPECT_FALSE(ready.has_header("Retry-After"));
}

TEST_F(DamagedMapTest, AMapOfANewerProgramIsNotCalledDamaged) {
  Damage("PRAGMA user_version = 99");
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  ExpectProblem(client.Get("/v1/maps/hall/report"), 500, "map_unsupported");
  EXPECT_EQ(Json(client.Get("/v1/maps"))["maps"][0]["code"], "map_unsupported");
}

TEST_F(DamagedMapTest, OneDamagedTileIsRefusedAlone) {
  Damage("UPDATE mosaic_tile SET checksum = checksum + 1 WHERE z = 0");
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  EXPECT_EQ(client.Get("/v1/maps/hall/tiles/1/-1/2.jpg").status, 200);
  const auto response = client.Get("/v1/maps/hall/tiles/0/0/0.jpg");
  ExpectProblem(response, 500, "map_damaged");
  EXPECT_THAT(response.body, AllOf(HasSubstr("mosaic tile 0/0/0"), Not(HasSubstr(folder_.path().string()))));
  EXPECT_EQ(client.Get("/readyz").status, 200);
}

}  // namespace
}  // namespace floorloc
