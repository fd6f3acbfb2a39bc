// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/honesty/honesty_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

FixRecord Accepted(double error_m, double error_rad, double p_wrong) {
  FixRecord fix;
  fix.status = LocalizationStatus::kLocalized;
  fix.has_pose = true;
  fix.error_m = error_m;
  fix.error_rad = error_rad;
  fix.p_wrong = p_wrong;
  fix.nees = 3.0;
  return fix;
}

FrameRecord Frame(FramePlace place, const FixRecord& fix) { return {0, place, "mild", 10.0, {fix}}; }

FloorRecords SomeRecords() {
  FixRecord ambiguous = Accepted(0.3, 0.0, 0.4);
  ambiguous.status = LocalizationStatus::kAmbiguous;
  ambiguous.truth_listed = true;
  return {{"tiles",
           {Frame(FramePlace::kMap, Accepted(0.001, 0.001, 1e-6)), Frame(FramePlace::kMap, Accepted(0.011, 0.0, 1e-6)),
            Frame(FramePlace::kMap, ambiguous), Frame(FramePlace::kEdge, FixRecord())}},
          {"wood", {Frame(FramePlace::kOtherFloor, Accepted(kInfinity, kInfinity, 1e-5))}}};
}

TEST(Summarize, CountsByFloorConditionAndPlace) {
  const HonestyReport report = Summarize(SomeRecords());
  const auto& floors = report.tallies.at(SearchKind::kGlobal);
  const Tally& mild = floors.at("tiles").at("mild");
  EXPECT_EQ(mild.frames, 3);
  EXPECT_EQ(mild.right, 1);
  EXPECT_EQ(mild.wrong, 1);
  EXPECT_EQ(mild.ambiguous, 1);
  EXPECT_EQ(mild.truth_listed, 1);
  EXPECT_EQ(mild.nees.size(), 1U);
  EXPECT_EQ(floors.at("tiles").at("edge").not_localized, 1);
  EXPECT_EQ(floors.at("tiles").at("total").frames, 4);
  EXPECT_EQ(floors.at("wood").at("other_floor").wrong, 1);
  EXPECT_EQ(floors.at("wood").count("total"), 0U) << "frames off the map are not to be found";
  EXPECT_EQ(floors.at("all").at("mild").wrong, 1);
}

TEST(Summarize, JudgesEveryPoseByItsPWrong) {
  const HonestyReport report = Summarize(SomeRecords());
  const std::vector<ReliabilityBin>& bins = report.reliability.at(SearchKind::kGlobal);
  EXPECT_EQ(bins[0].count, 1U);  // the ambiguous one
  EXPECT_EQ(bins[0].events, 1U);
  EXPECT_EQ(bins[5].count, 1U);
  EXPECT_EQ(bins[6].count, 2U);
  EXPECT_EQ(bins[6].events, 1U);
  EXPECT_NEAR(report.expected_wrong.at(SearchKind::kGlobal), 1.2e-5, 1e-12);
}

TEST(Wrong, IsBeyondTenMillimetresOrOneDegree) {
  EXPECT_FALSE(Accepted(0.0099, 0.0, 0.0).wrong());
  EXPECT_TRUE(Accepted(0.0101, 0.0, 0.0).wrong());
  EXPECT_FALSE(Accepted(0.0, 0.0174, 0.0).wrong());
  EXPECT_TRUE(Accepted(0.0, 0.0176, 0.0).wrong());
  EXPECT_FALSE(FixRecord().wrong()) << "no pose, no error";
}

TEST(Summarize, NamesTheFramesOfWrongFixes) {
  const HonestyReport report = Summarize(SomeRecords());
  ASSERT_EQ(report.wrong_fixes.size(), 2U);
  EXPECT_EQ(report.wrong_fixes[0].floor, "tiles");
  EXPECT_EQ(report.wrong_fixes[0].fix.error_m, 0.011);
  EXPECT_EQ(report.wrong_fixes[1].place, FramePlace::kOtherFloor);
}

TEST(OrderedRows, PutsConditionsFirstAndTheTotalLast) {
  const std::map<std::string, Tally> rows = {{"total", {}}, {"hard", {}}, {"edge", {}}, {"clean", {}}};
  EXPECT_THAT(OrderedRows(rows), ::testing::ElementsAre("clean", "hard", "edge", "total"));
}

TEST(HonestyJson, HoldsTheTallies) {
  const nlohmann::json json = nlohmann::json::parse(ToJson(Summarize(SomeRecords())));
  EXPECT_EQ(json.at("frames"), 5);
  EXPECT_EQ(json.at("searches").at("global").at("floors").at("tiles").at("mild").at("wrong"), 1);
  EXPECT_EQ(json.at("searches").at("global").at("reliability").at(6).at("poses"), 2);
}

TEST(DrawReliability, ShowsABinPerDecadeThatHasPoses) {
  FloorRecords records = SomeRecords();
  records["wood"].push_back(Frame(FramePlace::kMap, Accepted(0.001, 0.0, 5e-3)));
  const std::string svg = DrawReliability(Summarize(records));
  EXPECT_THAT(svg, ::testing::StartsWith("<svg"));
  EXPECT_THAT(svg, ::testing::HasSubstr("1 of 2 wrong"));
  EXPECT_THAT(svg, ::testing::HasSubstr("0 of 1 wrong"));
  std::size_t circles = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
    ++circles;
  }
  EXPECT_EQ(circles, 4U);
}

TEST(HonestyReport, CountsWrongPosesByTheShareOfTheViewThatAgrees) {
  FrameRecord record;
  for (const auto& [support, wrong] : std::vector<std::pair<double, bool>>{{0.13, true}, {0.85, false}, {1.0, false}}) {
    FixRecord fix = Accepted(wrong ? 1.0 : 0.0, 0.0, 1e-9);
    fix.support_area = support;
    record.fixes.push_back(fix);
  }
  record.fixes.push_back(Accepted(0.0, 0.0, 1e-9));  // not compared with a mosaic
  const HonestyReport report = Summarize({{"floor", {record}}});
  const auto& bins = report.by_support.at(SearchKind::kGlobal);
  ASSERT_EQ(bins.size(), 10U);
  EXPECT_EQ(bins[1], std::make_pair(1, 1));
  EXPECT_EQ(bins[8], std::make_pair(1, 0));
  EXPECT_EQ(bins[9], std::make_pair(1, 0));
  std::ostringstream table;
  PrintReport(table, report);
  EXPECT_NE(table.str().find("wrong by support area"), std::string::npos);
}

}  // namespace
}  // namespace floorloc
