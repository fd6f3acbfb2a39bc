// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/api/localize_json.h"
#include "server/api/tracking_json.h"
#include "tests/server/fixture/openapi_contract.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using nlohmann::json;

// An image of a floor of tiles that does not tell on which of them it was taken.
FixRecord AmbiguousOnTiles() {
  FixRecord record;
  record.sequence = 1;
  record.map = "hall";
  record.map_version = std::string(64, 'a');
  record.search = "global";
  record.result.status = LocalizationStatus::kAmbiguous;
  record.result.alternatives = {{Pose2(1.0, 2.0, 0.5), 40, 0.5}, {Pose2(1.3, 2.0, 0.5), 39, 0.5}};
  LatticeObservation seen;
  seen.lattice.basis << 0.3, 0.001, -0.001, 0.2;
  seen.map_extent = {0.0, 3.0, 0.0, 2.0};
  seen.map_from_base = Pose2(1.0, 2.0, 0.5);
  seen.covariance = Eigen::Vector3d(1e-6, 2e-6, 3e-6).asDiagonal();
  seen.covariance(0, 2) = seen.covariance(2, 0) = 5e-7;
  record.result.lattice = seen;
  return record;
}

std::vector<std::string> Misfits(const char* schema, const json& value) {
  return OpenApiContract().Validate({{"$ref", std::string("#/components/schemas/") + schema}}, value, schema);
}

TEST(LatticeJsonTest, AnAnswerHasThePoseModuloTheLattice) {
  const json answer = json::parse(FormatLocalizeResponse(AmbiguousOnTiles(), {}));
  EXPECT_THAT(Misfits("LocalizeAnswer", answer), testing::IsEmpty());
  EXPECT_FALSE(answer.contains("pose"));
  const json& lattice = answer["lattice"];
  EXPECT_EQ(lattice["basis"], json({{0.3, -0.001}, {0.001, 0.2}}));
  EXPECT_EQ(lattice["pose"], json({{"x", 1.0}, {"y", 2.0}, {"yaw", 0.5}}));
  EXPECT_EQ(lattice["covariance"], json({1e-6, 0.0, 5e-7, 0.0, 2e-6, 0.0, 5e-7, 0.0, 3e-6}));
  EXPECT_EQ(lattice["places"], 100);
}

TEST(LatticeJsonTest, OnAnyOtherFloorThereIsNone) {
  FixRecord record = AmbiguousOnTiles();
  record.result.lattice.reset();
  EXPECT_FALSE(json::parse(FormatLocalizeResponse(record, {})).contains("lattice"));
}

TEST(LatticeJsonTest, AVehiclesAlternativesAreThoseOfAllItsImages) {
  FrameReport report;
  report.view.alternatives = {{Pose2(1.0, 2.0, 0.6), 0, 0.75}};
  report.view.alternatives_ns = 1'500'000'000;
  const json answer = json::parse(FormatFrameResponse(report, AmbiguousOnTiles(), {}));
  EXPECT_THAT(Misfits("FrameAnswer", answer), testing::IsEmpty());
  ASSERT_EQ(answer["alternatives"].size(), 1U);
  EXPECT_EQ(answer["alternatives"][0]["weight"], 0.75);
  EXPECT_EQ(answer["alternatives"][0]["stamp"], 1.5);
  EXPECT_EQ(answer["lattice"]["places"], 100);
  report.view.alternatives.clear();
  EXPECT_EQ(json::parse(FormatFrameResponse(report, AmbiguousOnTiles(), {}))["alternatives"].size(), 2U);
}

TEST(LatticeJsonTest, OdometryTellsThemToo) {
  OdometryReport report;
  report.messages = {MessageOutcome::kUsed};
  EXPECT_FALSE(json::parse(FormatOdometryResponse(report, {"hall", std::string(64, 'a')})).contains("alternatives"));
  report.view.alternatives = {{Pose2(1.0, 2.0, 0.6), 0, 0.75}};
  const json answer = json::parse(FormatOdometryResponse(report, {"hall", std::string(64, 'a')}));
  EXPECT_THAT(Misfits("OdometryAnswer", answer), testing::IsEmpty());
  EXPECT_EQ(answer["alternatives"][0]["map"], "hall");
}

}  // namespace
}  // namespace floorloc
