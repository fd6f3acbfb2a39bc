// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/tile_floor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "mapbuilder/simulation/procedural_floor.h"

namespace floorloc {
namespace {

constexpr double kResolutionM = 0.003;  // a tile is 100 pixels
constexpr int kTilePx = 100;
constexpr int kColumns = 8;
constexpr int kRows = 5;

PixelGrid Hall() { return {{kColumns * kTilePx, kRows * kTilePx}, kResolutionM}; }

cv::Mat Tile(const cv::Mat& floor, int index) {
  return floor(cv::Rect(index % kColumns * kTilePx, index / kColumns * kTilePx, kTilePx, kTilePx));
}

double Difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

// Number of tiles that are not exactly as most are. The first one may be singular itself.
int Singular(const cv::Mat& floor) {
  int fewest = kColumns * kRows;
  for (const int reference : {0, 1, 2}) {
    int differing = 0;
    for (int i = 0; i < kColumns * kRows; ++i) {
      differing += Difference(Tile(floor, i), Tile(floor, reference)) > 0.0 ? 1 : 0;
    }
    fewest = std::min(fewest, differing);
  }
  return fewest;
}

TEST(TileFloorTest, AllTilesOfAFloorWithoutVariationAreEqual) {
  EXPECT_EQ(Singular(PaintTileFloor("tiles-identical", Hall(), 1)), 0);
}

TEST(TileFloorTest, NearlyAlikeTilesAllDiffer) {
  EXPECT_EQ(Singular(PaintTileFloor("tiles", Hall(), 1)), kColumns * kRows - 1);
}

TEST(TileFloorTest, TheShareOfSingularTilesIsExactAndAtLeastOne) {
  EXPECT_EQ(Singular(PaintTileFloor("tiles-singular-5", Hall(), 1)), 2);  // of 40
  EXPECT_EQ(Singular(PaintTileFloor("tiles-singular-1", Hall(), 1)), 1);
  EXPECT_EQ(Singular(PaintTiles({.singular_share = 0.3}, Hall(), 1)), 12);
}

TEST(TileFloorTest, SingularitiesAreVisible) {
  const cv::Mat without = PaintTileFloor("tiles-identical", Hall(), 3);
  const cv::Mat with = PaintTiles({.singular_share = 1.0}, Hall(), 3);
  for (int i = 0; i < kColumns * kRows; ++i) {
    EXPECT_GT(Difference(Tile(with, i), Tile(without, i)), 20.0) << i;
  }
}

TEST(TileFloorTest, LaidTilesDifferAtTheJointsAndByLittle) {
  const cv::Mat exact = PaintTileFloor("tiles-identical", Hall(), 1);
  const cv::Mat laid = PaintTileFloor("tiles-grout", Hall(), 1);
  EXPECT_EQ(Singular(laid), kColumns * kRows - 1);
  EXPECT_LT(cv::norm(laid, exact, cv::NORM_L1) / static_cast<double>(3 * laid.total()), 8.0);
}

TEST(TileFloorTest, OffsetsAreNotLargerThanSaid) {
  // A light tile that is 2 pixels off covers grout of its place at one side and leaves as much free at the other.
  const cv::Mat exact = PaintTiles({}, Hall(), 1);
  const cv::Mat laid = PaintTiles({.max_offset_m = 2.0 * kResolutionM}, Hall(), 1);
  const cv::Rect inner(5 * kTilePx, 2 * kTilePx, kTilePx, kTilePx);
  double best = 1e9;
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      best = std::min(best, cv::norm(laid(inner), exact(inner + cv::Point(du, dv)), cv::NORM_L1));
    }
  }
  EXPECT_LT(best, cv::norm(laid(inner), exact(inner + cv::Point(5, 0)), cv::NORM_L1));
}

TEST(TileFloorTest, TurnedTilesAreOneOfFourPrints) {
  const cv::Mat floor = PaintTileFloor("tiles-turned", Hall(), 1);
  const cv::Rect print(1, 1, kTilePx - 2, kTilePx - 2);
  std::vector<cv::Mat> kinds;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const cv::Mat tile = Tile(floor, i);
    const bool known = std::ranges::any_of(kinds, [&](const cv::Mat& kind) { return Difference(kind, tile) == 0.0; });
    if (!known) {
      kinds.push_back(tile);
    }
  }
  EXPECT_EQ(kinds.size(), 4U);
}

TEST(TileFloorTest, EqualSeedsPaintEqualFloorsAndOthersOthers) {
  for (const std::string& name : TileFloorNames()) {
    const cv::Mat floor = PaintTileFloor(name, Hall(), 1);
    EXPECT_EQ(Difference(floor, PaintTileFloor(name, Hall(), 1)), 0.0) << name;
    EXPECT_GT(Difference(floor, PaintTileFloor(name, Hall(), 2)), 0.0) << name;
  }
}

TEST(TileFloorTest, CutTilesFillTheFloorToItsEdges) {
  const PixelGrid cut{{250, 130}, kResolutionM};
  const cv::Mat floor = PaintTileFloor("tiles-identical", cut, 1);
  EXPECT_EQ(floor.size(), cut.size_px);
  EXPECT_EQ(Difference(floor(cv::Rect(200, 100, 50, 30)), floor(cv::Rect(0, 0, 50, 30))), 0.0);
}

TEST(TileFloorTest, EveryTiledFloorIsAProceduralFloor) {
  for (const std::string& name : TileFloorNames()) {
    EXPECT_EQ(Difference(PaintProceduralFloor(name, Hall(), 1), PaintTileFloor(name, Hall(), 1)), 0.0) << name;
  }
  EXPECT_THROW(PaintTileFloor("wood", Hall(), 1), std::invalid_argument);
  EXPECT_THROW(PaintProceduralFloor("marble", Hall(), 1), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
