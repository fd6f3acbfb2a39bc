// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "tests/server/fixture/server_fixture.h"
#include "web/assets.h"

namespace floorloc {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class RoutesTest : public testing::Test {
 protected:
  TestServer server_;
  ContractClient client_{server_.port()};
};

TEST_F(RoutesTest, ListsMapsAndNamesTheDamagedOne) {
  const json maps = Json(client_.Get("/v1/maps"))["maps"];
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0]["name"], "broken");
  EXPECT_EQ(maps[0]["status"], "error");
  EXPECT_EQ(maps[0]["code"], "map_damaged");
  EXPECT_NE(maps[0]["error"], "");
  EXPECT_EQ(maps[1]["name"], "hall");
  EXPECT_EQ(maps[1]["status"], "ready");
  EXPECT_GT(maps[1]["layers"][0]["keypoints"].get<int>(), 100);
}

TEST_F(RoutesTest, DescribesOneMap) {
  EXPECT_EQ(Json(client_.Get("/v1/maps/hall"))["extent"]["x_max"], 1.2);
  EXPECT_EQ(Json(client_.Get("/v1/maps/hall"))["scale"]["sigma"], 0.0025);
  EXPECT_EQ(Json(client_.Get("/v1/maps/hall"))["scale"]["sources"][0], "mounting");
  const json lattice = Json(client_.Get("/v1/maps/hall"))["lattice"];
  EXPECT_EQ(lattice["basis"], json({{0.3, -0.01}, {0.01, 0.2}}));
  EXPECT_EQ(lattice["point"], json({0.5, 0.25}));
  EXPECT_EQ(lattice["extent"]["x_max"], 1.2);
  EXPECT_EQ(Json(client_.Get("/v1/maps/broken"))["status"], "error");
  ExpectProblem(client_.Get("/v1/maps/cellar"), 404, "unknown_map");
  ExpectProblem(client_.Get("/v1/maps/..%2Fhall"), 404, "not_found");
}

TEST_F(RoutesTest, TellsTheQualityOfTheFloor) {
  const json quality = Json(client_.Get("/v1/maps/hall/quality"));
  int keypoints = 0;
  for (const json& cell : quality["cells"]) {
    keypoints += cell["keypoints"].get<int>();
    EXPECT_GE(cell["observations"].get<double>(), 1.0);
  }
  EXPECT_EQ(keypoints, Json(client_.Get("/v1/maps/hall"))["layers"][0]["keypoints"]);
  EXPECT_EQ(quality["map_version"], Json(client_.Get("/v1/maps/hall"))["version"]);
}

TEST_F(RoutesTest, ServesTilesWithTheVersionAsETag) {
  const auto tile = client_.Get("/v1/maps/hall/tiles/1/-1/2.jpg");
  EXPECT_EQ(tile.status, 200);
  EXPECT_EQ(tile.get_header_value("Content-Type"), "image/jpeg");
  EXPECT_EQ(tile.body.substr(0, 2), "\xFF\xD8");
  EXPECT_EQ(tile.get_header_value("Cache-Control"), "no-cache");
  const std::string etag = tile.get_header_value("ETag");
  const auto again = client_.Get("/v1/maps/hall/tiles/1/-1/2.jpg", {{"If-None-Match", etag}});
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.body, "");
  const std::string version = etag.substr(1, etag.size() - 2);
  EXPECT_THAT(client_.Get("/v1/maps/hall/tiles/1/-1/2.jpg?v=" + version).get_header_value("Cache-Control"),
              HasSubstr("immutable"));
}

TEST_F(RoutesTest, MissingTilesAreNotFound) {
  for (const std::string tile : {"1/0/0", "9/0/0", "-1/0/0", "0/99999999999/0", "0/a/0", "0/0/1.5", "0/0/"}) {
    SCOPED_TRACE(tile);
    const auto response = client_.Get("/v1/maps/hall/tiles/" + tile + ".jpg");
    ExpectProblem(response, 404, tile == "0/0/" ? "not_found" : "tile_not_found");
  }
}

TEST_F(RoutesTest, ServesTheBuildReport) {
  EXPECT_EQ(Json(client_.Get("/v1/maps/hall/report"))["frames"]["used"], 2);
  ExpectProblem(client_.Get("/v1/maps/broken/report"), 500, "map_damaged");
}

TEST_F(RoutesTest, RefusesAWrongSince) {
  ExpectProblem(client_.Get("/v1/maps/hall/fixes?since=-1"), 400, "invalid_parameter");
  ExpectProblem(client_.Get("/v1/maps/hall/fixes?since=now"), 400, "invalid_parameter");
}

TEST_F(RoutesTest, UnknownAddressesAndMethods) {
  ExpectProblem(client_.Get("/v1/nothing"), 404, "not_found");
  ExpectProblem(client_.Get("/v1/maps/"), 404, "not_found");
  const auto response = client_.Delete("/v1/maps");
  ExpectProblem(response, 405, "method_not_allowed");
  EXPECT_EQ(response.get_header_value("Allow"), "GET, HEAD");
  EXPECT_EQ(client_.Post("/v1/vehicles/a", "{}", "application/json").get_header_value("Allow"),
            "DELETE, GET, HEAD, PUT");
  ExpectProblem(client_.Send("OPTIONS", "/v1/maps"), 405, "method_not_allowed");
  ExpectProblem(client_.Send("PATCH", "/v1/maps"), 405, "method_not_allowed");
}

TEST_F(RoutesTest, HeadAnswersWithoutBody) {
  const auto response = client_.Send("HEAD", "/v1/maps");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.body, "");
}

TEST_F(RoutesTest, ReadinessEndsWhenTheServerDrains) {
  EXPECT_EQ(client_.Get("/livez").status, 200);
  EXPECT_EQ(client_.Get("/readyz").status, 200);
  server_.app().state().draining = true;
  ExpectProblem(client_.Get("/readyz"), 503, "draining");
  EXPECT_EQ(client_.Get("/livez").status, 200);
}

TEST(ReadinessTest, IsNotGivenWithoutMaps) {
  const TemporaryFolder empty;
  TestServer server({}, empty.path());
  ContractClient client(server.port());
  ExpectProblem(client.Get("/readyz"), 503, "no_maps");
  EXPECT_TRUE(Json(client.Get("/v1/maps"))["maps"].empty());
}

TEST_F(RoutesTest, CountsWhatItDid) {
  client_.Get("/v1/maps/hall");
  client_.Get("/v1/maps/cellar");
  const std::string metrics = client_.Get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr(R"(floorloc_http_requests_total{route="/v1/maps/{map}",method="GET",code="200"} 1)"));
  EXPECT_THAT(metrics, HasSubstr(R"(floorloc_http_requests_total{route="/v1/maps/{map}",method="GET",code="404"} 1)"));
  EXPECT_THAT(metrics, HasSubstr("floorloc_maps_ready 1\n"));
  EXPECT_THAT(metrics, HasSubstr("floorloc_maps_failed 1\n"));
  EXPECT_THAT(metrics, HasSubstr(R"(floorloc_http_refusals_total{route="/v1/maps/{map}",reason="unknown_map"} 1)"));
  EXPECT_THAT(metrics, HasSubstr(R"(floorloc_http_request_seconds_count{route="/v1/maps/{map}"} 1)"))
      << "refusals take no time";
}

TEST_F(RoutesTest, ThePageMayOnlyTalkToItsServer) {
  const auto page = client_.Get("/");
  EXPECT_EQ(page.status, 200);
  const std::string policy = page.get_header_value("Content-Security-Policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, testing::Not(HasSubstr("unsafe")));
  EXPECT_EQ(page.get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(client_.Get("/", {{"If-None-Match", page.get_header_value("ETag")}}).status, 304);
}

TEST_F(RoutesTest, ServesEveryFileOfThePage) {
  EXPECT_GE(AllWebAssets().size(), 4U);
  for (const WebAsset& asset : AllWebAssets()) {
    EXPECT_EQ(client_.Get("/web/" + std::string(asset.name)).body, asset.content) << asset.name;
  }
  ExpectProblem(client_.Get("/web/nothing.js"), 404, "not_found");
}

// Every route is documented, and every documented route exists and works.
TEST(DocumentTest, DocumentAndRoutesAgree) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", folder.path() / "hall.floormap");
  TestServer server({}, folder.path(), Persistence::kKeep);
  ContractClient client(server.port());
  std::set<std::string> routed;
  for (const Route& route : server.app().router().routes()) {
    routed.insert(route.method + " " + route.pattern);
  }
  EXPECT_EQ(routed, client.contract().DocumentedOperations());
  const std::string jpeg = SharedMaps().KnownJpeg();
  client.Put("/v1/vehicles/a", VehicleBody().dump());
  client.Post("/v1/maps/hall/localize?vehicle=a", jpeg, "image/jpeg");
  client.Post("/v1/vehicles/a/frames?stamp=1", jpeg, "image/jpeg");
  client.Post("/v1/vehicles/a/odometry", R"({"stamp":1.1,"dx":0,"dy":0,"dyaw":0})", "application/json");
  client.Post("/v1/vehicles/a/initialpose", R"({"x":0,"y":0,"yaw":0})", "application/json");
  for (const std::string target :
       {"/", "/web/index.html", "/web/data/api.js", "/livez", "/readyz", "/metrics", "/openapi.yaml", "/v1/maps",
        "/v1/maps/hall", "/v1/maps/hall/versions", "/v1/maps/hall/tiles/0/0/0.jpg", "/v1/maps/hall/report",
        "/v1/maps/hall/quality", "/v1/maps/hall/fixes", "/v1/maps/hall/success", "/v1/vehicles", "/v1/vehicles/a",
        "/v1/vehicles/a/diagnosis", "/v1/vehicles/a/last_frame"}) {
    client.Get(target);
  }
  client.Stream("/v1/events", [](const std::string& text) { return !text.empty(); });
  client.Delete("/v1/vehicles/a");
  const std::filesystem::path file = folder.path() / "hall.floormap";
  std::ifstream stream(file, std::ios::binary);
  const std::string map{std::istreambuf_iterator<char>(stream), {}};
  const std::string version = Json(client.Post("/v1/maps/a/versions", map, "application/octet-stream"))["version"];
  client.Post("/v1/maps/a/versions/" + version + "/activate", "", "");
  FloorCamera given = SharedMaps().floor().camera();
  given.camera.cx += 1.0;
  WriteHall(SharedMaps().floor(), given, file);  // another version
  std::ifstream other(file, std::ios::binary);
  const std::string second{std::istreambuf_iterator<char>(other), {}};
  const std::string unused = Json(client.Post("/v1/maps/a/versions", second, "application/octet-stream"))["version"];
  client.Delete("/v1/maps/a/versions/" + unused);
  client.Delete("/v1/maps/a");
  EXPECT_EQ(client.contract().exercised(), client.contract().DocumentedOperations());
}

TEST(OpenApiContractTest, FindsWhatIsWrong) {
  OpenApiContract contract;
  const auto check = [&](const std::string& body) {
    return contract.Check({"GET", "/livez", 200, "application/json", body});
  };
  EXPECT_TRUE(check(R"({"status":"alive"})").empty());
  EXPECT_FALSE(check(R"({"status":"dead"})").empty());
  EXPECT_FALSE(check(R"({"status":"alive","more":1})").empty());
  EXPECT_FALSE(check("{}").empty());
  EXPECT_FALSE(check("[]").empty());
  EXPECT_FALSE(check("alive").empty());
  EXPECT_FALSE(contract.Check({"GET", "/livez", 200, "text/plain", "alive"}).empty());
  EXPECT_FALSE(contract.Check({"GET", "/livez", 204, "", ""}).empty());
  EXPECT_FALSE(contract.Check({"GET", "/v1/nothing", 200, "application/json", "{}"}).empty());
  EXPECT_FALSE(contract.Check({"GET", "/livez", 500, "application/json", "{}"}).empty());
}

}  // namespace
}  // namespace floorloc
