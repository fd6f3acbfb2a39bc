// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/mosaic.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/coverage/coverage.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// The synthetic floor's mosaic from frames at their true poses under ideal conditions.
class MosaicTest : public ::testing::Test {
 protected:
  using Tiles = std::map<TileId, cv::Mat>;
  struct Shared {
    FloorTexture texture;
    RectM extent;
    MosaicLayout layout;
    Tiles tiles;
    std::vector<Pose2> upper_poses;  // of the frames in the floor's upper half
    RectM floor_in_base;
    Tiles over_background;  // of these, over a background that exists only west of kKnownWest
  };
  struct Recipe {
    int threads = 0;
    RectM extent;
    MosaicBackground background;
  };
  static constexpr double kKnownWest = 0.8;
  static constexpr int kBackgroundGray = 40;

  static MosaicOptions OptionsFor(const Survey& survey) {
    MosaicOptions options;
    options.resolution_m = survey.camera.floor.resolution_m;
    options.jpeg_quality = 95;
    return options;
  }

  static std::vector<std::optional<Pose2>> TruePoses(const Survey& survey) {
    std::vector<std::optional<Pose2>> poses;
    for (const SurveyFrame& info : survey.frames) {
      poses.push_back(InterpolatePose(survey.ground_truth, info.stamp_ns));
    }
    return poses;
  }

  static Tiles Compose(const Survey& survey, const Recipe& recipe) {
    const std::vector<LoadedSurvey> surveys = {{survey, survey.camera, std::make_shared<Rectifier>(survey.camera)}};
    std::vector<BuildFrame> frames;
    Exposure exposure;
    for (const SurveyFrame& info : survey.frames) {
      frames.emplace_back();
      frames.back().info = info;
      exposure.frame_gain.push_back(1.0);
    }
    const cv::Mat& mask = surveys[0].rectifier->mask();
    exposure.flat_field.push_back(cv::Mat(mask.size(), CV_32F, cv::Scalar(1.0)));
    MosaicOptions options = OptionsFor(survey);
    options.run.threads = recipe.threads;
    Tiles tiles;
    ComposeMosaic({frames, surveys, TruePoses(survey), exposure, recipe.extent, recipe.background},
                  MakeMosaicLayout(recipe.extent, options), options, [&](const std::vector<MosaicTile>& finished) {
                    for (const MosaicTile& tile : finished) {
                      EXPECT_FALSE(tiles.contains(tile.id)) << "a tile twice";
                      tiles[tile.id] = cv::imdecode(tile.jpeg, cv::IMREAD_COLOR);
                    }
                  });
    return tiles;
  }

  static MosaicPatch Background(const RectM& square, int side_px) {
    MosaicPatch patch = MosaicPatch::Empty(side_px);
    const double columns = std::clamp((kKnownWest - square.x_min) / square.width_m(), 0.0, 1.0) * side_px;
    const cv::Rect west(0, 0, static_cast<int>(columns), side_px);
    patch.bgr(west).setTo(cv::Scalar::all(kBackgroundGray));
    patch.valid(west).setTo(255);
    return patch;
  }

  static Shared MakeShared() {
    const TemporaryFolder folder;
    SimulateOptions options = SyntheticFloor(1).SurveyOptions(folder.path() / "survey");
    options.conditions = ConditionLevels::FromName("clean");
    Simulate(options);
    Shared s;
    s.texture = MakeFloorTexture(options.floor);
    Survey survey = ReadSurvey(folder.path() / "survey");
    s.floor_in_base = survey.camera.floor.roi;
    s.extent = CoverageGrid(TruePoses(survey), std::vector<RectM>(survey.frames.size(), s.floor_in_base)).Extent();
    s.layout = MakeMosaicLayout(s.extent, OptionsFor(survey));
    s.tiles = Compose(survey, {1, s.extent, nullptr});
    const Tiles again = Compose(survey, {4, s.extent, nullptr});
    EXPECT_EQ(again.size(), s.tiles.size());
    for (const auto& [id, image] : again) {
      EXPECT_EQ(cv::norm(image, s.tiles.at(id), cv::NORM_INF), 0.0) << "depends on the number of threads";
    }
    std::erase_if(survey.frames, [&](const SurveyFrame& frame) {
      const Pose2 pose = *InterpolatePose(survey.ground_truth, frame.stamp_ns);
      const bool upper = (pose * s.floor_in_base.Center()).y() > 0.5;
      if (upper) {
        s.upper_poses.push_back(pose);
      }
      return !upper;
    });
    s.over_background = Compose(survey, {0, s.extent, Background});
    return s;
  }

  static const Shared& TheMosaic() {
    static const Shared shared = MakeShared();
    return shared;
  }

  // The texture of a tile's area.
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
    cv::Mat image;
    cv::remap(soft, image, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
    return image;
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
  for (const auto& [id, image] : s.tiles) {
    if (id.z != s.layout.max_zoom || !WhollyInside(s, id)) {
      continue;
    }
    const cv::Mat mosaic = GrayFloat(image);
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

// Largest distance of a point from the border of the images of the upper half, metres; negative outside.
double DepthInViews(const std::vector<Pose2>& poses, const RectM& view, const Eigen::Vector2d& point) {
  double depth = -1.0;
  for (const Pose2& pose : poses) {
    const Eigen::Vector2d p = pose.Inverse() * point;
    depth = std::max(depth, std::min({p.x() - view.x_min, view.x_max - p.x(), p.y() - view.y_min, view.y_max - p.y()}));
  }
  return depth;
}

TEST_F(MosaicTest, NewImagesBlendSmoothlyIntoTheOldMosaic) {
  const Shared& s = TheMosaic();
  std::array<int, 4> checked{};
  const double step_m = s.layout.resolution_m;
  for (const auto& [id, image] : s.over_background) {
    if (id.z != s.layout.max_zoom) {
      continue;
    }
    const cv::Mat gray = GrayFloat(image);
    const cv::Mat floor = GrayFloat(TextureOf(s, id));
    const double side_m = s.layout.TileSide(id.z);
    for (int v = 3; v < gray.rows; v += 12) {
      for (int u = 3; u < gray.cols; u += 12) {
        const Eigen::Vector2d p(id.x * side_m + (u + 0.5) * step_m, (id.y + 1) * side_m - (v + 0.5) * step_m);
        const double depth_m = DepthInViews(s.upper_poses, s.floor_in_base, p);
        const bool known = p.x() < kKnownWest - 0.01;
        const cv::Rect around = cv::Rect(u - 3, v - 3, 7, 7) & cv::Rect(0, 0, gray.cols, gray.rows);
        const double shown = cv::mean(gray(around))[0];
        const double real = cv::mean(floor(around))[0];
        if (depth_m > 0.04) {
          EXPECT_NEAR(shown, real, 12.0) << p.transpose();
          ++checked[0];
        } else if (depth_m < -0.01 && known) {
          EXPECT_NEAR(shown, kBackgroundGray, 8.0) << p.transpose();
          ++checked[1];
        } else if (depth_m > 0.009 && depth_m < 0.013 && known) {
          EXPECT_GT(shown, kBackgroundGray + 20.0) << "no fade at " << p.transpose();
          EXPECT_LT(shown, real - 20.0) << "no fade at " << p.transpose();
          ++checked[2];
        } else if (depth_m > 0.009 && p.x() > kKnownWest + 0.01) {
          EXPECT_NEAR(shown, real, 12.0) << p.transpose();
          ++checked[3];
        }
      }
    }
  }
  for (const int count : checked) {
    EXPECT_GT(count, 20);
  }
}

TEST_F(MosaicTest, EveryLevelIsTheFinerOneShrunk) {
  const Shared& s = TheMosaic();
  int checked = 0;
  for (const auto& [id, image] : s.tiles) {
    if (id.z == s.layout.max_zoom || !WhollyInside(s, id)) {
      continue;
    }
    cv::Mat four(2 * s.layout.tile_px, 2 * s.layout.tile_px, CV_8UC3);
    for (int i = 0; i < 4; ++i) {  // y grows up, rows grow down
      const TileId child{id.z + 1, 2 * id.x + i % 2, 2 * id.y + i / 2};
      s.tiles.at(child).copyTo(
          four(cv::Rect(i % 2 * s.layout.tile_px, (1 - i / 2) * s.layout.tile_px, s.layout.tile_px, s.layout.tile_px)));
    }
    cv::resize(four, four, image.size(), 0, 0, cv::INTER_AREA);
    EXPECT_LT(cv::mean(cv::abs(GrayFloat(four) - GrayFloat(image)))[0], 3.0) << id.z << " " << id.x << " " << id.y;
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
    EXPECT_GE(layout.TileSide(0), width_m);  // so at most two tiles wide for any origin of the extent
    EXPECT_LE(layout.TileSide(0), std::max(2.0 * width_m, 0.256) * (1.0 + 1e-9));
  }
}

}  // namespace
}  // namespace floorloc
