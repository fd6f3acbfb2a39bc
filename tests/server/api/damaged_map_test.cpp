// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <random>

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
      const auto map = LoadMap("hall", file_, LocalizerOptions());
      MapCatalog catalog;
      VersionStore store(folder_.path(), nullptr, false);
      const MapLibrary library(folder_.path(), {}, catalog, store);
      const json summary = json::parse(FormatMap(*map, library));
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

// A damage that no checksum of a row finds; the content version does.
TEST_F(DamagedMapTest, IsVerifiedAsAWhole) {
  for (const char* damage :
       {"UPDATE mosaic_tile SET checksum = checksum + 1 WHERE z = 0", "DELETE FROM mosaic_tile WHERE z = 0",
        "DROP TABLE mosaic_tile", "DROP TABLE link", "UPDATE camera SET fx = 1.5 * fx", "UPDATE map SET x_max = 9e999",
        "UPDATE map SET area_m2 = 2 * area_m2", "UPDATE frame SET x = x + 0.001", "DELETE FROM keypoint_tile",
        "UPDATE map SET report_json = '{}'", "UPDATE map SET content_version = lower(hex(randomblob(32)))"}) {
    Damage(damage);
    EXPECT_EQ(LoadMap("hall", file_, LocalizerOptions())->error_code, "map_damaged") << damage;
  }
}

// A bit that differs is either refused, or it is one that no reader looks at: free space, comments of the schema, and
// what the content version leaves out on purpose (schema/README.md).
TEST_F(DamagedMapTest, NoBitThatCountsIsFlippedUnseen) {
  Damage("");
  std::ifstream stream(file_, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  const auto before = LoadMap("hall", file_, LocalizerOptions());
  std::mt19937 random(7);
  int refused = 0;
  constexpr int kFlips = 60;
  for (int i = 0; i < kFlips; ++i) {
    const std::size_t bit = std::uniform_int_distribution<std::size_t>(0, 8 * whole.size() - 1)(random);
    std::string flipped = whole;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    std::ofstream(file_, std::ios::binary) << flipped;
    const auto map = LoadMap("hall", file_, LocalizerOptions());
    refused += map->ready() ? 0 : 1;
    if (map->ready()) {
      const MapKeypoints& keypoints = map->localizer->map().keypoints;
      EXPECT_EQ(map->info().content_version, before->info().content_version) << bit;
      EXPECT_EQ(keypoints.size(), before->localizer->map().keypoints.size()) << bit;
      EXPECT_EQ(cv::norm(keypoints.descriptors, before->localizer->map().keypoints.descriptors), 0.0) << bit;
      EXPECT_EQ(map->ReadTile({1, -1, 2}), before->database->ReadMosaicTile({1, -1, 2})) << bit;
    }
  }
  EXPECT_GT(refused, kFlips / 3);  // a small map is half free space
}

// Without copies of its own, the server reads the file that was opened; what is written into it is not of its version.
TEST_F(DamagedMapTest, AFileThatIsOverwrittenIsNotReadOn) {
  Damage("");
  TestServer server({}, folder_.path());
  ContractClient client(server.port());
  const std::string tile = "/v1/maps/hall/tiles/1/-1/2.jpg";
  EXPECT_EQ(client.Get(tile).status, 200);
  { std::ofstream(file_, std::ios::in | std::ios::ate) << "more"; }
  const auto response = client.Get(tile);
  ExpectProblem(response, 500, "map_unavailable");
  EXPECT_THAT(response.body, AllOf(HasSubstr("hall.floormap was written"), Not(HasSubstr(folder_.path().string()))));
}

}  // namespace
}  // namespace floorloc
