// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/prune_keypoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace floorloc {
namespace {

// 1 m x 1 m of covered floor.
CoverageGrid SquareMetre() { return CoverageGrid({Pose2()}, {RectM{0.0, 1.0, 0.0, 1.0}}); }

// Random points with random usefulness, `left` of them in the left half of the square metre and `right` in the right.
struct TwoHalves {
  TwoHalves(int left, int right) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < left + right; ++i) {
      points.emplace_back(0.5 * unit(random) + (i < left ? 0.0 : 0.5), unit(random));
      usefulness.push_back(unit(random));
    }
  }
  std::ptrdiff_t CountLeft(const std::vector<int>& chosen) const {
    return std::count_if(chosen.begin(), chosen.end(),
                         [&](int i) { return points[static_cast<std::size_t>(i)].x() < 0.5; });
  }

  std::vector<Eigen::Vector2d> points;
  std::vector<double> usefulness;
};

PruningOptions Budget(double per_m2) {
  PruningOptions options;
  options.max_per_m2 = per_m2;
  return options;
}

TEST(PruneKeypointsTest, AllStayWithinTheBudget) {
  const TwoHalves floor(100, 50);
  EXPECT_EQ(ChooseEvenly(floor.points, floor.usefulness, SquareMetre(), Budget(150.0)).size(), 150U);
}

TEST(PruneKeypointsTest, TheBudgetHoldsAndIsUsed) {
  const TwoHalves floor(3000, 2000);
  for (const double budget : {10.0, 333.0, 1000.0, 4000.0}) {
    const auto chosen = ChooseEvenly(floor.points, floor.usefulness, SquareMetre(), Budget(budget));
    EXPECT_NEAR(static_cast<double>(chosen.size()), budget, 2.0);
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  }
}

TEST(PruneKeypointsTest, PoorFloorKeepsAllAndRichFloorTakesTheRest) {
  const TwoHalves floor(100, 5000);
  const auto chosen = ChooseEvenly(floor.points, floor.usefulness, SquareMetre(), Budget(1000.0));
  EXPECT_EQ(floor.CountLeft(chosen), 100);
  EXPECT_NEAR(static_cast<double>(chosen.size()), 1000.0, 2.0);
}

TEST(PruneKeypointsTest, RichFloorIsSharedEvenly) {
  const TwoHalves floor(2000, 8000);
  const auto chosen = ChooseEvenly(floor.points, floor.usefulness, SquareMetre(), Budget(1000.0));
  EXPECT_NEAR(static_cast<double>(floor.CountLeft(chosen)), 500.0, 5.0);
}

TEST(PruneKeypointsTest, TheMostUsefulOfEachCellStay) {
  const TwoHalves floor(3000, 3000);
  const PruningOptions options = Budget(2000.0);
  const auto chosen = ChooseEvenly(floor.points, floor.usefulness, SquareMetre(), options);
  const auto cell = [&](std::size_t i) { return (floor.points[i] / options.cell_m).array().floor().matrix().eval(); };
  std::vector<char> stays(floor.points.size(), 0);
  for (const int i : chosen) {
    stays[static_cast<std::size_t>(i)] = 1;
  }
  for (std::size_t i = 0; i < stays.size(); i += 7) {
    for (std::size_t j = 0; j < stays.size(); ++j) {
      if (stays[i] > stays[j] && cell(i) == cell(j)) {
        EXPECT_GE(floor.usefulness[i], floor.usefulness[j]);
      }
    }
  }
}

// A cell at the edge of the map that is covered to one fifth gets one fifth of a cell's budget.
TEST(PruneKeypointsTest, PartsOfCellsGetPartsOfTheBudget) {
  const CoverageGrid coverage({Pose2()}, {RectM{0.0, 0.12, 0.0, 0.1}});
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 1200; ++i) {
    const int row = i / 40;
    points.emplace_back(i % 40 * 0.003 + 0.001, row * 0.1 / 30.0 + 0.001);
  }
  const auto chosen = ChooseEvenly(points, std::vector<double>(points.size(), 1.0), coverage, Budget(10000.0));
  const auto in_edge = std::count_if(chosen.begin(), chosen.end(),
                                     [&](int i) { return points[static_cast<std::size_t>(i)].x() >= 0.1; });
  EXPECT_NEAR(static_cast<double>(chosen.size()), 120.0, 2.0);
  EXPECT_NEAR(static_cast<double>(in_edge), 20.0, 2.0);
}

}  // namespace
}  // namespace floorloc
