// SPDX-License-Identifier: Apache-2.0
#include "core/map/mosaic_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <thread>
#include <utility>

#include "core/map/map_error.h"

namespace floorloc {
namespace {

constexpr int kTilePx = 32;
constexpr int kMaxZoom = 3;
constexpr double kResolutionM = 0.001;
constexpr double kTileM = kTilePx * kResolutionM;
constexpr std::size_t kTileBytes = kTilePx * kTilePx;
constexpr std::size_t kPlenty = 1 << 20;
constexpr TileId kFar{0, 21'600'000, 166'750'000};  // 691 km east and 5336 km north, as in UTM

// A mosaic of bright random tiles around the map's origin; counts the tile requests.
class RandomMosaic {
 public:
  explicit RandomMosaic(int reach = 2) {
    cv::RNG random(7);
    for (int y = -reach; y < reach; ++y) {
      for (int x = -reach; x < reach; ++x) {
        cv::Mat tile(kTilePx, kTilePx, CV_8UC1);
        random.fill(tile, cv::RNG::UNIFORM, 40, 256);
        Set(x, y, tile);
      }
    }
  }

  void Set(int x, int y, const cv::Mat& gray) {
    cv::imencode(".png", gray, encoded_[{kMaxZoom, x, y}]);
    const cv::Mat all(gray.size(), CV_8UC1, cv::Scalar(255));
    expected_[{x, y}] = cv::max(NormalizeContrast(gray, all, ContrastOptions()), 1);
  }
  void SetBytes(int x, int y, const std::vector<std::uint8_t>& bytes) { encoded_[{kMaxZoom, x, y}] = bytes; }
  void Remove(int x, int y) { encoded_.erase({kMaxZoom, x, y}); }

  MosaicTileSource Source() const {
    return [this](const TileId& id) -> std::optional<std::vector<std::uint8_t>> {
      ++calls_;
      const auto it = encoded_.find(id);
      return it == encoded_.end() ? std::nullopt : std::optional(it->second);
    };
  }
  MosaicRaster Raster(std::size_t memory_bytes = kPlenty) const {
    return {Source(), {kTilePx, kMaxZoom, kResolutionM}, ContrastOptions(), memory_bytes};
  }
  int calls() const { return calls_; }

  // Expected value of a raster at a map point.
  std::uint8_t At(const Eigen::Vector2d& p) const {
    const int x = static_cast<int>(std::floor(p.x() / kTileM));
    const int y = static_cast<int>(std::floor(p.y() / kTileM));
    const int column = static_cast<int>(std::floor((p.x() - x * kTileM) / kResolutionM));
    const int row_from_below = static_cast<int>(std::floor((p.y() - y * kTileM) / kResolutionM));
    const auto it = expected_.find({x, y});
    return it == expected_.end() ? std::uint8_t{0} : it->second.at<std::uint8_t>(kTilePx - 1 - row_from_below, column);
  }

 private:
  std::map<TileId, std::vector<std::uint8_t>> encoded_;
  std::map<std::pair<int, int>, cv::Mat> expected_;
  mutable std::atomic<int> calls_ = 0;
};

RectM TileRect(int x, int y) {
  constexpr double kInside = 0.1 * kResolutionM;
  return {x * kTileM + kInside, (x + 1) * kTileM - kInside, y * kTileM + kInside, (y + 1) * kTileM - kInside};
}

int CountValidPixels(const RasterPatch& patch) { return cv::countNonZero(patch.gray); }

bool Same(const RasterPatch& a, const RasterPatch& b) {
  return a.gray.size() == b.gray.size() && cv::norm(a.gray, b.gray, cv::NORM_INF) == 0.0 && a.x_left_m == b.x_left_m &&
         a.y_top_m == b.y_top_m;
}

// Rectangles that cross tile borders and the edge of the mosaic.
std::vector<RectM> RandomRects(int count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-2.5 * kTileM, 2.0 * kTileM);
  std::uniform_real_distribution<double> side(0.0, 1.7 * kTileM);
  std::vector<RectM> rects;
  for (int i = 0; i < count; ++i) {
    const double x = place(random);
    const double y = place(random);
    rects.push_back({x, x + side(random), y, y + side(random)});
  }
  return rects;
}

TEST(MosaicRasterTest, HasEveryPixelWhereTheMapHasIt) {
  const RandomMosaic mosaic;
  const MosaicRaster raster = mosaic.Raster();
  for (const RectM& rect : RandomRects(100)) {
    const RasterPatch patch = raster.Cut(rect);
    ASSERT_EQ(patch.gray.type(), CV_8UC1);
    for (int row = 0; row < patch.gray.rows; ++row) {
      for (int column = 0; column < patch.gray.cols; ++column) {
        const Eigen::Vector2d p(patch.x_left_m + column * kResolutionM, patch.y_top_m - row * kResolutionM);
        ASSERT_EQ(patch.gray.at<std::uint8_t>(row, column), mosaic.At(p)) << p.transpose();
        ASSERT_LT((patch.PixelFromMap(p) - Eigen::Vector2d(column, row)).norm(), 1e-9);
      }
    }
  }
}

TEST(MosaicRasterTest, CoversTheRectangleAndNoMore) {
  const RandomMosaic mosaic;
  const MosaicRaster raster = mosaic.Raster();
  for (const RectM& rect : RandomRects(100)) {
    const RasterPatch patch = raster.Cut(rect);
    const Eigen::Vector2d upper_left = patch.PixelFromMap({rect.x_min, rect.y_max});
    const Eigen::Vector2d lower_right = patch.PixelFromMap({rect.x_max, rect.y_min});
    for (const double first : {upper_left.x(), upper_left.y()}) {
      EXPECT_GE(first, -0.5 - 1e-9);
      EXPECT_LE(first, 0.5 + 1e-9);
    }
    for (const double last : {lower_right.x() - patch.gray.cols, lower_right.y() - patch.gray.rows}) {
      EXPECT_GE(last, -1.5 - 1e-9);
      EXPECT_LE(last, -0.5 + 1e-9);
    }
  }
}

TEST(MosaicRasterTest, ReadsTheFinestLevelOnly) {
  std::vector<TileId> asked;
  const MosaicRaster raster(
      [&](const TileId& id) {
        asked.push_back(id);
        return std::nullopt;
      },
      {kTilePx, kMaxZoom, kResolutionM}, ContrastOptions(), kPlenty);
  raster.Cut(TileRect(-4, 5));
  EXPECT_EQ(asked, std::vector<TileId>({{kMaxZoom, -4, 5}}));
}

// Every level shows the same floor at the same place.
TEST(MosaicRasterTest, BlurLevelsKeepTheFloorInPlace) {
  const RandomMosaic mosaic;
  const MosaicRaster raster = mosaic.Raster();
  const RasterPatch sharp = raster.Cut(TileRect(-1, 0));
  cv::Mat smooth;
  const cv::Mat kernel = (cv::Mat_<double>(1, 5) << 1.0, 4.0, 6.0, 4.0, 1.0) / 16.0;
  cv::sepFilter2D(sharp.gray, smooth, CV_8U, kernel, kernel);
  for (int level = 1; level <= 2; ++level) {
    const RasterPatch blurred = raster.Cut(TileRect(-1, 0), level);
    EXPECT_NEAR(blurred.resolution_m, kResolutionM * (1 << level), 1e-12);
    EXPECT_EQ(blurred.gray.cols, kTilePx >> level);
    for (int k = 2; k < blurred.gray.cols - 2; ++k) {
      const Eigen::Vector2d pixel = sharp.PixelFromMap(
          {blurred.x_left_m + k * blurred.resolution_m, blurred.y_top_m - (k + 1) * blurred.resolution_m});
      const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      EXPECT_LT((pixel - Eigen::Vector2d(at.x, at.y)).norm(), 1e-6) << level;
      if (level == 1) {
        EXPECT_NEAR(blurred.gray.at<std::uint8_t>(k + 1, k), smooth.at<std::uint8_t>(at), 1) << k;
      }
    }
  }
}

TEST(MosaicRasterTest, BlurringDoesNotFillGaps) {
  RandomMosaic mosaic;
  cv::Mat holed(kTilePx, kTilePx, CV_8UC1, cv::Scalar(120));
  holed(cv::Rect(8, 8, 16, 16)).setTo(0);
  mosaic.Set(0, 0, holed);
  const RasterPatch patch = mosaic.Raster().Cut(TileRect(0, 0), 1);
  EXPECT_TRUE(patch.has_gaps);
  EXPECT_EQ(patch.gray.at<std::uint8_t>(patch.gray.rows / 2, patch.gray.cols / 2), 0);
  EXPECT_FALSE(mosaic.Raster().Cut(TileRect(-1, -1), 1).has_gaps);
}

TEST(MosaicRasterTest, AHoleInTheFloorIsZeroWithItsEdge) {
  RandomMosaic mosaic;
  cv::Mat tile(kTilePx, kTilePx, CV_8UC1, cv::Scalar(120));
  tile(cv::Rect(10, 12, 6, 5)).setTo(3);  // black, with traces of JPEG
  mosaic.Set(0, 0, tile);
  const RasterPatch patch = mosaic.Raster().Cut(TileRect(0, 0));
  ASSERT_EQ(patch.gray.size(), tile.size());
  const cv::Rect hole_and_edge(8, 10, 10, 9);
  EXPECT_EQ(cv::countNonZero(patch.gray(hole_and_edge)), 0);
  EXPECT_EQ(CountValidPixels(patch), kTilePx * kTilePx - hole_and_edge.area());
}

TEST(MosaicRasterTest, MissingTilesAreNoFloor) {
  RandomMosaic mosaic;
  mosaic.Remove(0, -1);
  const MosaicRaster raster = mosaic.Raster();
  EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(0, -1))), 0);
  EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(100, -100))), 0);
  EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(-1, -1))), kTilePx * kTilePx);
}

TEST(MosaicRasterTest, BrokenTilesAreNoFloor) {
  std::vector<std::uint8_t> other_size;
  cv::imencode(".png", cv::Mat(kTilePx, kTilePx + 1, CV_8UC1, cv::Scalar(90)), other_size);
  std::vector<std::uint8_t> noise(500);
  std::mt19937 random(3);
  std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(random()); });
  std::vector<std::uint8_t> header_only(other_size.begin(), other_size.begin() + 24);
  std::vector<std::uint8_t> huge;
  cv::imencode(".jpg", cv::Mat(kTilePx, kTilePx, CV_8UC1, cv::Scalar(90)), huge);
  const std::vector<std::uint8_t> start_of_frame{0xFF, 0xC0};
  const auto header = std::search(huge.begin(), huge.end(), start_of_frame.begin(), start_of_frame.end());
  ASSERT_LT(header, huge.end() - 9);
  std::fill(header + 5, header + 9, std::uint8_t{0xFE});  // height and width
  const std::vector<std::uint8_t> nothing;
  for (const std::vector<std::uint8_t>& bytes : {nothing, noise, other_size, header_only, huge}) {
    RandomMosaic mosaic;
    mosaic.SetBytes(0, 0, bytes);
    const MosaicRaster raster = mosaic.Raster();
    EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(0, 0))), 0) << bytes.size() << " bytes";
    EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(1, 0))), kTilePx * kTilePx);
  }
}

TEST(MosaicRasterTest, TilesThatTheMapRefusesAreNoFloor) {
  const MosaicTileSource refuses = [](const TileId&) -> std::optional<std::vector<std::uint8_t>> {
    throw MapError("a tile is damaged; build the map again");
  };
  const MosaicRaster raster(refuses, {kTilePx, kMaxZoom, kResolutionM}, ContrastOptions(), kPlenty);
  EXPECT_EQ(CountValidPixels(raster.Cut(TileRect(0, 0))), 0);
}

TEST(MosaicRasterTest, WildRectanglesSeeNoFloor) {
  const RandomMosaic mosaic;
  const MosaicRaster raster = mosaic.Raster();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double wild : {1e300, -1e300, 1e12, infinity, -infinity, std::nan("")}) {
    const RectM all_wild{wild, wild, wild, wild};
    const RectM wild_x{wild, wild, 0.0, 0.01};
    const RectM wild_y{0.0, 0.01, wild, wild};
    for (const RectM& rect : {all_wild, wild_x, wild_y}) {
      EXPECT_EQ(CountValidPixels(raster.Cut(rect)), 0) << wild;
    }
  }
  EXPECT_EQ(mosaic.calls(), 0);
}

TEST(MosaicRasterTest, IsTheSameFarFromTheOrigin) {
  const RandomMosaic mosaic;
  const MosaicRaster near = mosaic.Raster();
  const MosaicTileSource moved = [source = mosaic.Source()](const TileId& id) {
    return source({id.z, id.x - kFar.x, id.y - kFar.y});
  };
  const MosaicRaster far(moved, {kTilePx, kMaxZoom, kResolutionM}, ContrastOptions(), kPlenty);
  const Eigen::Vector2d shift = kTileM * Eigen::Vector2d(kFar.x, kFar.y);
  for (const double x : {-0.0405, -0.0005, 0.0125}) {
    const RectM rect{x, x + 0.0402, -0.0208, 0.0151};
    const RasterPatch a = near.Cut(rect);
    const RasterPatch b =
        far.Cut({rect.x_min + shift.x(), rect.x_max + shift.x(), rect.y_min + shift.y(), rect.y_max + shift.y()});
    ASSERT_EQ(a.gray.size(), b.gray.size());
    EXPECT_EQ(cv::norm(a.gray, b.gray, cv::NORM_INF), 0.0);
    EXPECT_NEAR(b.x_left_m - shift.x(), a.x_left_m, 1e-8);
    EXPECT_NEAR(b.y_top_m - shift.y(), a.y_top_m, 1e-8);
  }
}

class MosaicRasterMemoryTest : public ::testing::Test {
 protected:
  static constexpr int kKept = 100;

  // Cuts the tiles (first, 0) to (last, 0), in this order; returns how many of them were decoded.
  int Decoded(int first, int last) {
    const int before = mosaic_.calls();
    for (int x = first; x <= last; ++x) {
      raster_.Cut(TileRect(x, 0));
    }
    return mosaic_.calls() - before;
  }

  RandomMosaic mosaic_;  // most requested tiles do not exist, which is cached, too
  MosaicRaster raster_ = mosaic_.Raster(kKept * kTileBytes);
};

TEST_F(MosaicRasterMemoryTest, TilesAreDecodedOnceWhileTheyFit) {
  EXPECT_EQ(Decoded(0, kKept - 1), kKept);
  EXPECT_EQ(Decoded(0, kKept - 1), 0);
}

TEST_F(MosaicRasterMemoryTest, TheLeastRecentlyUsedTileMakesRoom) {
  Decoded(0, kKept - 1);
  EXPECT_EQ(Decoded(0, 0), 0);          // now the most recent
  EXPECT_EQ(Decoded(kKept, kKept), 1);  // instead of tile 1
  EXPECT_EQ(Decoded(0, 0), 0);
  EXPECT_EQ(Decoded(2, kKept), 0);
  EXPECT_EQ(Decoded(1, 1), 1);
}

TEST_F(MosaicRasterMemoryTest, ATileThatCameBackIsTheSame) {
  const RasterPatch first = raster_.Cut(TileRect(1, 1));
  Decoded(0, 2 * kKept);
  const int before = mosaic_.calls();
  EXPECT_TRUE(Same(raster_.Cut(TileRect(1, 1)), first));
  EXPECT_EQ(mosaic_.calls(), before + 1);
}

TEST(MosaicRasterTest, EveryThreadGetsTheSamePatches) {
  const RandomMosaic mosaic(8);  // 256 tiles, of which 64 are cached
  const MosaicRaster raster = mosaic.Raster(0);
  std::vector<RectM> rects;
  std::vector<RasterPatch> alone;
  for (const RectM& rect : RandomRects(200)) {
    rects.push_back(
        {4.0 * rect.x_min, 4.0 * rect.x_min + rect.width_m(), 4.0 * rect.y_min, 4.0 * rect.y_min + rect.height_m()});
    alone.push_back(mosaic.Raster().Cut(rects.back()));
  }
  std::atomic<int> different = 0;
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < 8; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = 0; i < rects.size(); ++i) {
          const std::size_t k = (i + 25 * t) % rects.size();
          different += Same(raster.Cut(rects[k]), alone[k]) ? 0 : 1;
        }
      });
    }
  }
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace floorloc
