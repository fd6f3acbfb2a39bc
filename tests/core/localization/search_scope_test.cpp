// SPDX-License-Identifier: Apache-2.0
#include "core/localization/search_scope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

const RectM kRoi{0.0, 0.4, -0.2, 0.2};
const SearchOptions kOptions;
const SearchableMap kPlain;
const SearchableMap kRepeating{true, false};
const SearchableMap kUpright{false, true};

double Apart(double a, double b) { return std::abs(WrapAngle(a - b)); }

double ToTheNearest(const std::vector<double>& headings, double yaw) {
  double least = 10.0;
  for (const double heading : headings) {
    least = std::min(least, Apart(heading, yaw));
  }
  return least;
}

TEST(SearchScopeTest, APriorContainsWhatItAllows) {
  const SearchScope scope{PosePrior{Pose2(1.0, 2.0, 3.0), 0.2, 0.1}, std::nullopt};
  EXPECT_TRUE(scope.Contains(Pose2(1.1, 2.1, 3.05)));
  EXPECT_FALSE(scope.Contains(Pose2(1.3, 2.0, 3.0)));
  EXPECT_FALSE(scope.Contains(Pose2(1.0, 2.0, 3.15)));
  EXPECT_TRUE(scope.Contains(Pose2(1.0, 2.0, 3.08)));
  EXPECT_TRUE(SearchScope().Contains(Pose2(1e6, 0.0, 0.0)));
}

TEST(SearchScopeTest, APriorsGuideReachesWhereAnyAllowedPosePutsAKeypoint) {
  const PosePrior prior{Pose2(1.0, 2.0, 0.5), 0.2, 0.3};
  for (const SearchScope& scope : SearchScopes(prior, kRoi, kPlain, kOptions)) {
    ASSERT_TRUE(scope.guide.has_value());
    for (const double turn : {-0.3, 0.0, 0.3}) {
      for (const double ahead : {-0.2, 0.2}) {
        const Pose2 allowed = prior.map_from_base * Pose2(ahead, 0.0, turn);
        for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0.0, -0.2), Eigen::Vector2d(0.4, 0.2)}) {
          EXPECT_LE((allowed * corner - scope.guide->target_from_query * corner).norm(), scope.guide->radius_m + 1e-9);
        }
      }
    }
  }
}

TEST(SearchScopeTest, EffortGrows) {
  const auto with_prior = SearchScopes(PosePrior(), kRoi, kPlain, kOptions);
  ASSERT_GE(with_prior.size(), 2U);
  for (std::size_t i = 1; i < with_prior.size(); ++i) {
    EXPECT_LT(with_prior[i].guide->stride, with_prior[i - 1].guide->stride);
  }
  EXPECT_EQ(with_prior.back().guide->stride, 1);
  const auto whole = SearchScopes(std::nullopt, kRoi, kPlain, kOptions);
  ASSERT_EQ(whole.size(), 3U);
  EXPECT_GT(whole[0].probes, 0);
  EXPECT_EQ(whole[1].probes, 0);  // 0: the number in the index's options
  EXPECT_FALSE(whole[1].indistinct);
  EXPECT_TRUE(whole[2].indistinct);
}

TEST(SearchScopeTest, AThoroughSearchUsesEveryKeypoint) {
  const SearchScope near = ThoroughScope(PosePrior(), kRoi, kPlain, kOptions);
  ASSERT_TRUE(near.guide.has_value());
  EXPECT_TRUE(near.thorough);
  EXPECT_EQ(near.guide->stride, 1);
  EXPECT_FALSE(near.Contains(Pose2(5.0, 0.0, 0.0))) << "it stays within the prior";
  const SearchScope whole = ThoroughScope(std::nullopt, kRoi, kPlain, kOptions);
  EXPECT_TRUE(whole.thorough);
  EXPECT_TRUE(whole.indistinct);
  EXPECT_FALSE(whole.guide.has_value());
}

TEST(SearchScopeTest, AFloorThatRepeatsItselfIsSearchedWithAllEffortAtOnce) {
  const auto whole = SearchScopes(std::nullopt, kRoi, kRepeating, kOptions);
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole[0].probes, 0);
  EXPECT_FALSE(whole[0].indistinct);
}

TEST(SearchScopeTest, HeadingsOfAPriorLeaveNoneOutAndTheGuideStillReaches) {
  for (const double yaw_radius : {0.02, 0.3, std::numbers::pi}) {
    const PosePrior prior{Pose2(1.0, 2.0, 0.5), 0.2, yaw_radius};
    for (const SearchScope& scope : SearchScopes(prior, kRoi, kUpright, kOptions)) {
      ASSERT_FALSE(scope.headings.empty());
      for (double turn = -yaw_radius; turn <= yaw_radius; turn += 0.01) {
        const Pose2 allowed = prior.map_from_base * Pose2(0.2, 0.0, turn);
        const double off = ToTheNearest(scope.headings, allowed.yaw());
        EXPECT_LE(off, 0.5 * kOptions.heading_step_rad + 1e-9) << yaw_radius << " " << turn;
        const auto reached = std::any_of(scope.headings.begin(), scope.headings.end(), [&](double heading) {
          const Pose2 guess(prior.map_from_base.x(), prior.map_from_base.y(), heading);
          const Eigen::Vector2d corner(0.4, 0.2);
          return (allowed * corner - guess * corner).norm() <= scope.guide->radius_m + 1e-9;
        });
        EXPECT_TRUE(reached) << yaw_radius << " " << turn;
      }
    }
  }
}

TEST(SearchScopeTest, AMapWithUprightDescriptorsIsSearchedAtAllHeadingsBeforeItIsGivenUp) {
  const auto whole = SearchScopes(std::nullopt, kRoi, kUpright, kOptions);
  ASSERT_EQ(whole.size(), 4U);
  EXPECT_TRUE(whole.front().headings.empty());
  EXPECT_EQ(whole[2].strongest, kOptions.heading_keypoints);
  const SearchScope thorough = ThoroughScope(std::nullopt, kRoi, kUpright, kOptions);
  EXPECT_TRUE(thorough.thorough);
  for (const SearchScope& scope : {whole[2], thorough}) {
    for (double yaw = -3.2; yaw < 3.2; yaw += 0.05) {
      EXPECT_LE(ToTheNearest(scope.headings, yaw), 0.5 * kOptions.heading_step_rad + 1e-9) << yaw;
    }
  }
}

TEST(SearchScopeTest, OnlyAPriorThatStatesASmallRiskIsUnquestioned) {
  PosePrior prior;
  EXPECT_FALSE(SearchScope().IsUnquestioned(kOptions));
  EXPECT_FALSE((SearchScope{prior, std::nullopt}.IsUnquestioned(kOptions)));
  prior.p_elsewhere = 0.1;
  EXPECT_FALSE((SearchScope{prior, std::nullopt}.IsUnquestioned(kOptions)));
  prior.p_elsewhere = 0.5 * kOptions.unquestioned_p_elsewhere;
  EXPECT_TRUE((SearchScope{prior, std::nullopt}.IsUnquestioned(kOptions)));
}

TEST(SearchScopeTest, WhereAPriorStatesItsRiskOtherPlacesAreAsLikely) {
  PosePrior prior;
  EXPECT_EQ(SearchScope().WeightOutside(kOptions), 1.0);
  EXPECT_EQ((SearchScope{prior, std::nullopt}.WeightOutside(kOptions)), kOptions.prior_failure_rate);
  prior.p_elsewhere = 0.1;
  EXPECT_EQ((SearchScope{prior, std::nullopt}.WeightOutside(kOptions)), 1.0);
}

TEST(SearchScopeTest, ASearchModuloALatticeTakesAllHeadingsWhereTheMapAllowsIt) {
  const FloorLattice lattice{0.3 * Eigen::Matrix2d::Identity(), 0.0, 1.0};
  const SearchScope upright = ModuloScope(lattice, kUpright, kOptions);
  EXPECT_TRUE(upright.modulo);
  EXPECT_EQ(upright.strongest, kOptions.modulo_keypoints);
  EXPECT_LE(ToTheNearest(upright.headings, 2.0), 0.5 * kOptions.heading_step_rad + 1e-9);
  const SearchScope plain = ModuloScope(lattice, kPlain, kOptions);
  EXPECT_TRUE(plain.modulo && plain.indistinct && plain.headings.empty());
}

}  // namespace
}  // namespace floorloc
