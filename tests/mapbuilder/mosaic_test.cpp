// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/coverage.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// The synthetic floor's mosaic from frames at their true poses under perfect conditions.
class MosaicTest : public ::testing::Test {
 protected:
  struct Shared {
    FloorTexture texture;
    RectM extent;
    MosaicLayout layout;
    std::map<TileId, cv::Mat> tiles;
  };

  static std::map<TileId, cv::Mat> Compose(const Survey& survey, int threads, Shared* shared) {
    std::vector<LoadedSurvey> surveys = {{survey, std::make_shared<Rectifier>(survey.camera)}};
    std::vector<BuildFrame> frames;
    std::vector<std::optional<Pose2>> poses;
    Exposure exposure;
    for (const SurveyFrame& info : survey.frames) {
      frames.emplace_back();
      frames.back().info = info;
      poses.push_back(InterpolatePose(survey.ground_truth, info.stamp_ns));
      exposure.frame_gain.push_back(1.0);
    }
    const cv::Mat& mask = surveys[0].rectifier->mask();
    exposure.flat_field.push_back(cv::Mat(mask.size(), CV_32F, cv::Scalar(1.0)));
    const std::vector<RectM> floors(frames.size(), survey.camera.floor.roi);
    shared->extent = CoverageGrid(poses, floors).Extent();
    MosaicOptions options;
    options.resolution_m = survey.camera.floor.resolution_m;
    options.jpeg_quality = 95;
    options.threads = threads;
    shared->layout = MakeMosaicLayout(shared->extent, options);
    std::map<TileId, cv::Mat> tiles;
    ComposeMosaic({frames, surveys, poses, exposure, shared->extent}, shared->layout, options,
                  [&](const std::vector<MosaicTile>& finished) {
                    for (const MosaicTile& tile : finished) {
                      EXPECT_FALSE(tiles.contains(tile.id)) << "a tile twice";
                      tiles[tile.id] = cv::imdecode(tile.jpeg, cv::IMREAD_COLOR);
                    }
                  });
    return tiles;
  }

  static const Shared& TheMosaic() {
    static const Shared shared = [] {
      const TemporaryFolder folder;
      SimulateOptions options = SyntheticFloor(1).SurveyOptions(folder.path() / "survey");
      options.conditions = ConditionLevels::FromName("clean");
      Simulate(options);
      Shared s;
      s.texture = MakeFloorTexture(options.floor);
      const Survey survey = ReadSurvey(folder.path() / "survey");
      s.tiles = Compose(survey, 1, &s);
      const std::map<TileId, cv::Mat> again = Compose(survey, 4, &s);
      EXPECT_EQ(again.size(), s.tiles.size());
      for (const auto& [id, picture] : again) {
        EXPECT_EQ(cv::norm(picture, s.tiles.at(id), cv::NORM_INF), 0.0) << "depends on the number of threads";
      }
      return s;
    }();
    return shared;
  }

  // What the texture shows where a tile lies.
  static cv::Mat TextureOf(const Shared& s, const TileId& tile) {
    const double side_m = s.layout.TileSide(tile.z);
    const double step_m = side_m / s.layout.tile_px;
    cv::Mat map(s.layout.tile_px, s.layout.tile_px, CV_32FC2);
    for (int v = 0; v < map.rows; ++v) {
      for (int u = 0; u < map.cols; ++u) {
        const Eigen::Vector2d p =
            s.texture.PixelFromMap({tile.x * side_m + (u + 0.5) * step_m, (tile.y + 1) * side_m - (v + 0.5) * step_m});
        map.at<cv::Vec2f>(v, u) = {static_cast<float>(p.x()), static_cast<float>(p.y())};
      }
    }
    cv::Mat soft;
    cv::GaussianBlur(s.texture.bgr, soft, cv::Size(), 0.5 * step_m / s.texture.resolution_m);
    cv::Mat picture;
    cv::remap(soft, picture, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
    return picture;
  }

  static cv::Mat GrayFloat(const cv::Mat& bgr) {
    cv::Mat gray;
    cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
    gray.convertTo(gray, CV_32F);
    return gray;
  }

  static bool WhollyInside(const Shared& s, const TileId& tile) {
    const double side_m = s.layout.TileSide(tile.z);
    return tile.x * side_m > s.extent.x_min + 0.03 && (tile.x + 1) * side_m < s.extent.x_max - 0.03 &&
           tile.y * side_m > s.extent.y_min + 0.03 && (tile.y + 1) * side_m < s.extent.y_max - 0.03;
  }
};

TEST_F(MosaicTest, EveryPixelShowsItsFloorPoint) {
  const Shared& s = TheMosaic();
  int checked = 0;
  for (const auto& [id, picture] : s.tiles) {
    if (id.z != s.layout.max_zoom || !WhollyInside(s, id)) {
      continue;
    }
    const cv::Mat mosaic = GrayFloat(picture);
    const cv::Mat floor = GrayFloat(TextureOf(s, id));
    cv::Mat window;
    cv::createHanningWindow(window, mosaic.size(), CV_32F);
    double response = 0.0;
    const cv::Point2d shift = cv::phaseCorrelate(floor, mosaic, window, &response);
    EXPECT_LT(std::hypot(shift.x, shift.y), 0.3) << id.x << " " << id.y;
    EXPECT_GT(response, 0.3) << id.x << " " << id.y;
    EXPECT_LT(cv::mean(cv::abs(mosaic - floor))[0], 6.0) << id.x << " " << id.y;
    ++checked;
  }
  EXPECT_GE(checked, 8);
}

TEST_F(MosaicTest, TilesCoverTheSurveyAndNoMore) {
  const Shared& s = TheMosaic();
  for (int z = 0; z <= s.layout.max_zoom; ++z) {
    const double side_m = s.layout.TileSide(z);
    for (int y = -2; y < 12; ++y) {
      for (int x = -2; x < 12; ++x) {
        const TileId id{z, x, y};
        const Eigen::Vector2d center((x + 0.5) * side_m, (y + 0.5) * side_m);
        const bool touches = x * side_m < s.extent.x_max && (x + 1) * side_m > s.extent.x_min &&
                             y * side_m < s.extent.y_max && (y + 1) * side_m > s.extent.y_min;
        if (WhollyInside(s, id)) {
          EXPECT_TRUE(s.tiles.contains(id)) << z << " " << x << " " << y;
        }
        if (!touches) {
          EXPECT_FALSE(s.tiles.contains(id)) << z << " " << x << " " << y;
        }
      }
    }
  }
}

TEST_F(MosaicTest, EveryLevelIsTheFinerOneShrunk) {
  const Shared& s = TheMosaic();
  int checked = 0;
  for (const auto& [id, picture] : s.tiles) {
    if (id.z == s.layout.max_zoom || !WhollyInside(s, id)) {
      continue;
    }
    cv::Mat four(2 * s.layout.tile_px, 2 * s.layout.tile_px, CV_8UC3);
    for (int i = 0; i < 4; ++i) {  // y counts up, rows count down
      const TileId child{id.z + 1, 2 * id.x + i % 2, 2 * id.y + i / 2};
      s.tiles.at(child).copyTo(
          four(cv::Rect(i % 2 * s.layout.tile_px, (1 - i / 2) * s.layout.tile_px, s.layout.tile_px, s.layout.tile_px)));
    }
    cv::resize(four, four, picture.size(), 0, 0, cv::INTER_AREA);
    EXPECT_LT(cv::mean(cv::abs(GrayFloat(four) - GrayFloat(picture)))[0], 3.0) << id.z << " " << id.x << " " << id.y;
    ++checked;
  }
  EXPECT_GE(checked, 1);
}

TEST(MosaicLayoutTest, TheCoarsestLevelIsFewTiles) {
  MosaicOptions options;
  options.resolution_m = 0.001;
  for (const double width_m : {0.01, 0.256, 0.257, 1.0, 7.7, 100.0, 3000.0}) {
    const MosaicLayout layout = MakeMosaicLayout({-3.0, -3.0 + width_m, 5.0, 5.0 + 0.5 * width_m}, options);
    EXPECT_EQ(layout.tile_px, 256);
    EXPECT_EQ(layout.resolution_m, 0.001);
    EXPECT_NEAR(layout.TileSide(layout.max_zoom), 0.256, 1e-12);
    EXPECT_GE(layout.TileSide(0), width_m);  // so at most two tiles wide, wherever the extent begins
    EXPECT_LE(layout.TileSide(0), std::max(2.0 * width_m, 0.256) * (1.0 + 1e-9));
  }
}

}  // namespace
}  // namespace floorloc
