// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/link_sigmas.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {
namespace {

// Links in a row of frames whose errors are `times` what their covariances say.
struct Row {
  explicit Row(int count, double times) {
    cv::RNG rng(11);
    map_from_base.emplace_back(Pose2());
    for (int i = 0; i < count; ++i) {
      map_from_base.emplace_back(Pose2(0.1 * (i + 1), 0.0, 0.0));
      Link link;
      link.first = i;
      link.second = i + 1;
      link.covariance = Eigen::Vector3d(1e-8, 1e-8, 4e-8).asDiagonal();
      link.first_from_second =
          Pose2(0.1 + times * rng.gaussian(1e-4), times * rng.gaussian(1e-4), times * rng.gaussian(2e-4));
      links.push_back(link);
    }
  }

  std::vector<std::optional<Pose2>> map_from_base;
  std::vector<Link> links;
};

TEST(RescaleSigmas, ResidualsAreWhatTheyClaimAfterwards) {
  for (const double times : {0.2, 1.0, 2.4}) {
    Row row(200, times);
    EXPECT_NEAR(RescaleSigmas(row.map_from_base, {}, &row.links), times, 0.1 * times);
    EXPECT_NEAR(MeasureLinks(row.links, row.map_from_base).rms_sigma, 1.0, 0.1);
  }
}

TEST(RescaleSigmas, WrongLinksStayVisible) {
  Row row(200, 0.5);
  for (std::size_t i = 0; i < row.links.size(); i += 20) {
    row.links[i].first_from_second = row.links[i].first_from_second * Pose2(0.01, 0.0, 0.0);
  }
  EXPECT_NEAR(RescaleSigmas(row.map_from_base, {}, &row.links), 0.5, 0.1);
  EXPECT_GT(MeasureLinks(row.links, row.map_from_base).rms_sigma, 5.0);
  Row wrong(200, 10.0);
  EXPECT_EQ(RescaleSigmas(wrong.map_from_base, {}, &wrong.links), LinkSigmaOptions().max_factor);
  EXPECT_GT(MeasureLinks(wrong.links, wrong.map_from_base).rms_sigma, 3.0);
}

TEST(RescaleSigmas, FewLinksTellNothing) {
  Row row(19, 0.2);
  EXPECT_EQ(RescaleSigmas(row.map_from_base, {}, &row.links), 1.0);
}

TEST(RescaleSigmas, OptionsAreChecked) {
  Row row(30, 1.0);
  EXPECT_THROW(RescaleSigmas(row.map_from_base, {0, 3.0}, &row.links), std::invalid_argument);
  EXPECT_THROW(RescaleSigmas(row.map_from_base, {20, 0.5}, &row.links), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
