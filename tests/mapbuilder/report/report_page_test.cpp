// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "mapbuilder/report/data_uri.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/odometry_drift.h"
#include "mapbuilder/report/report_html.h"
#include "mapbuilder/report/report_json.h"
#include "tests/mapbuilder/report/made_up_map.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ReportPageTest : public ::testing::Test {
 protected:
  std::string Html() const {
    const MapQuality quality = MeasureQuality(evidence_, options_);
    const Verdict verdict = AssessMap(evidence_, quality);
    const MosaicImage mosaic{cv::Mat(240, 320, CV_8UC3, cv::Scalar(128, 128, 128)), 0.01, {0.0, 3.2, 0.0, 2.4}};
    return ReportHtml({evidence_, quality, options_, verdict, mosaic});
  }
  nlohmann::json Json() const {
    const MapQuality quality = MeasureQuality(evidence_, options_);
    return nlohmann::json::parse(ReportJson(evidence_, quality, AssessMap(evidence_, quality)));
  }

  MapEvidence evidence_ = MakeMapEvidence();
  QualityOptions options_;
};

TEST_F(ReportPageTest, NothingIsFetchedFromElsewhere) {
  EXPECT_THAT(Html(), Not(HasSubstr("http")));
  EXPECT_THAT(Html(), Not(HasSubstr("src=")));
}

TEST_F(ReportPageTest, WhatIsMaskedIsShown) {
  EXPECT_THAT(Html(), Not(HasSubstr("id='masks'")));
  cv::Mat mask(480, 640, CV_8UC1, cv::Scalar(255));
  mask.colRange(0, 64).setTo(0);
  evidence_.map.info.masks = {{mask, true, {1, 2, 3}}};
  const std::string html = Html();
  EXPECT_THAT(html, HasSubstr("Masked 10 % of the image"));
  EXPECT_THAT(html, HasSubstr("data:image/jpeg;base64,AQID"));
  EXPECT_THAT(html, HasSubstr("--no-auto-mask"));
}

TEST_F(ReportPageTest, ByWhatTheFloorRepeatsItselfIsTold) {
  EXPECT_TRUE(Json()["lattices"].empty());
  MapLattice lattice;
  lattice.basis << 0.3, 0.01, -0.01, 0.2;
  lattice.point_m = {1.0, 2.0};
  lattice.share = 0.75;
  evidence_.map.info.lattices = {lattice};
  const nlohmann::json told = Json()["lattices"][0];
  EXPECT_EQ(told["basis"], nlohmann::json({{0.3, -0.01}, {0.01, 0.2}}));
  EXPECT_EQ(told["point"], nlohmann::json({1.0, 2.0}));
  EXPECT_EQ(told["share"], 0.75);
  EXPECT_THAT(Html(), HasSubstr("The floor repeats itself every"));
}

TEST_F(ReportPageTest, NamesFromOutsideAreEscaped) {
  evidence_.map.info.name = "<script>alert(1)</script>";
  evidence_.build.dropped = {{"<b>.jpg", "a<b", std::nullopt}};
  evidence_.map.info.surveys_json = R"([{"folder": "<img>", "frames": 3, "camera": "<i>"}])";
  const std::string html = Html();
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, Not(HasSubstr("<b>.jpg")));
  EXPECT_THAT(html, Not(HasSubstr("<img>")));
}

TEST_F(ReportPageTest, EveryZoneHasItsRowAndItsMark) {
  ClearKeypoints({0.4, 1.2, 0.8, 1.6}, &evidence_);
  ClearKeypoints({2.0, 2.7, 0.8, 1.6}, &evidence_);
  const std::string html = Html();
  for (const char* number : {"1", "2"}) {
    EXPECT_THAT(html, HasSubstr(std::string("data-zone-row='") + number + "'"));
    EXPECT_THAT(html, HasSubstr(std::string("class='mark' data-zone='") + number + "'"));
  }
  const nlohmann::json json = Json();
  ASSERT_EQ(json["resurvey"].size(), 2U);
  EXPECT_EQ(json["resurvey"][0]["reason"], "few_keypoints");
  EXPECT_NEAR(json["resurvey"][0]["x"], 0.8, 0.1);
  EXPECT_NEAR(json["resurvey"][1]["x"], 2.35, 0.1);
  EXPECT_EQ(json["verdict"], "look_at");
}

TEST_F(ReportPageTest, TheNumbersAreThoseOfTheMap) {
  const nlohmann::json json = Json();
  EXPECT_EQ(json["verdict"], "trust");
  EXPECT_EQ(json["map"]["frames"], evidence_.frames.size());
  EXPECT_EQ(json["held_out"]["localized"], 4);
  EXPECT_NEAR(json["held_out"]["median_m"], 3e-4, 1e-9);
  EXPECT_NEAR(json["floor"]["frames_per_cell"]["median"], 16, 4);
  EXPECT_NEAR(json["geometry"]["link_error_m"]["max"], 0.0, 1e-9);
}

TEST(OdometryDriftTest, IsTheDistanceFromTheMapAfterTheFirstFrame) {
  MapEvidence evidence = MakeMapEvidence();
  evidence.frames.resize(5);
  for (std::size_t i = 0; i < evidence.frames.size(); ++i) {
    const double step = static_cast<double>(i);
    evidence.frames[i].map_from_base = Pose2(1.0 + 0.5 * step, 2.0, 0.0);
    evidence.frames[i].odom_from_base = Pose2(0.0, 0.51 * step, 1.5707963267948966);  // in another frame, 2 % too long
  }
  const std::vector<OdometryDrift> drifts = FollowOdometry(evidence);
  ASSERT_EQ(drifts.size(), 1U);
  EXPECT_NEAR(drifts[0].travelled_m, 2.04, 1e-9);
  EXPECT_NEAR(drifts[0].largest_m, 0.04, 1e-9);
  EXPECT_NEAR(drifts[0].largest_rad, 0.0, 1e-9);
  evidence.frames[2].odom_from_base.reset();
  EXPECT_EQ(FollowOdometry(evidence)[0].samples.size(), 4U);
}

TEST(NumberTextTest, NumbersReadWell) {
  EXPECT_EQ(NumberText(1234567), "1,234,567");
  EXPECT_EQ(NumberText(-1234), "-1,234");
  EXPECT_EQ(NumberText(123), "123");
  EXPECT_EQ(LengthText(0.00042), "0.42 mm");
  EXPECT_EQ(LengthText(0.031), "3.1 cm");
  EXPECT_EQ(LengthText(2.5), "2.50 m");
  EXPECT_EQ(AreaText(0.854), "0.85 m²");
  EXPECT_EQ(AreaText(1240.3), "1,240 m²");
  EXPECT_EQ(PercentText(0.004), "0.4 %");
  EXPECT_EQ(PercentText(0.97), "97 %");
  EXPECT_EQ(PercentText(0.0), "0 %");
  EXPECT_EQ(FixedText(-0.0001, 2), "0.00");
}

TEST(NumberTextTest, QuantilesAreValues) {
  EXPECT_EQ(Quantile({}, 0.5), 0.0);
  EXPECT_EQ(Quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(Quantile({3.0, 1.0, 2.0}, 1.0), 3.0);
}

TEST(DataUriTest, Base64FollowsTheStandard) {
  const auto of = [](const std::string& text) { return Base64(std::vector<std::uint8_t>(text.begin(), text.end())); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace floorloc
