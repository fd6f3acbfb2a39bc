// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiffio.h>

#include <Eigen/LU>
#include <cstring>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/export/export_geotiff.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/export/export_nav2.h"
#include "mapbuilder/export/export_pose_graph.h"
#include "mapbuilder/export/export_tiles.h"
#include "tests/core/map/map_test_support.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using testing_map::ReadBytes;

constexpr int kTilePx = 64;
constexpr double kPixelM = 0.01;
constexpr double kTileM = kTilePx * kPixelM;

// Position-dependent smooth colours, which JPEG hardly changes. No floor at x > 0.9 and at the lower left.
cv::Vec3b ColorAt(double x, double y) {
  if (x > 0.9 || (x < 0.0 && y < -kTileM)) {
    return {0, 0, 0};
  }
  return {static_cast<std::uint8_t>(100 + 40 * x), static_cast<std::uint8_t>(100 + 40 * y), 140};
}

std::vector<std::uint8_t> TileAt(const TileId& id, int max_zoom) {
  const double step = kPixelM * (1 << (max_zoom - id.z));
  const double side = step * kTilePx;
  cv::Mat image(kTilePx, kTilePx, CV_8UC3);
  for (int v = 0; v < kTilePx; ++v) {
    for (int u = 0; u < kTilePx; ++u) {
      image.at<cv::Vec3b>(v, u) = ColorAt(id.x * side + (u + 0.5) * step, (id.y + 1) * side - (v + 0.5) * step);
    }
  }
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, 98});
  return jpeg;
}

// Tiles x = -1 ... 1, y = -2 ... 0 at the finest of two levels; the lower left one is missing.
class ExportTest : public ::testing::Test {
 protected:
  ExportTest() {
    testing_map::MapContent content = testing_map::MakeContent();
    content.info.extent = {-kTileM, 2.0 * kTileM, -2.0 * kTileM, kTileM};
    content.mosaic = {kTilePx, 1, kPixelM};
    content.tiles.clear();
    for (int x = -1; x <= 0; ++x) {
      for (int y = -1; y <= 0; ++y) {
        content.tiles.push_back({{0, x, y}, TileAt({0, x, y}, 1)});
      }
    }
    for (int x = -1; x <= 1; ++x) {
      for (int y = -2; y <= 0; ++y) {
        if (x != -1 || y != -2) {
          content.tiles.push_back({{1, x, y}, TileAt({1, x, y}, 1)});
        }
      }
    }
    tiles_ = content.tiles;
    content_ = content;
    testing_map::WriteMap(folder_.path() / "map.floormap", content);
  }

  MapDatabase Map() const { return MapDatabase(folder_.path() / "map.floormap"); }
  // The same tiles in a map that says that this is what was surveyed.
  MapDatabase MapOfExtent(const RectM& extent) const {
    testing_map::MapContent content = content_;
    content.info.extent = extent;
    const fs::path file = folder_.path() / ("map" + std::to_string(extent.x_max) + ".floormap");
    testing_map::WriteMap(file, content);
    return MapDatabase(file);
  }
  fs::path File(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
  std::vector<MosaicTile> tiles_;
  testing_map::MapContent content_;
};

// The tags of a classic little-endian TIFF: their values' bytes.
std::map<int, std::string> ReadTiffTags(const std::string& bytes) {
  const auto number = [&](std::size_t at, std::size_t size) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, size);
    return value;
  };
  std::map<int, std::string> tags;
  EXPECT_EQ(bytes.substr(0, 4), std::string("II*\0", 4));
  const std::size_t directory = number(4, 4);
  const std::map<std::uint32_t, std::size_t> type_bytes{{2, 1}, {3, 2}, {4, 4}, {12, 8}};
  for (std::size_t i = 0; i < number(directory, 2); ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    const auto size = type_bytes.find(number(entry + 2, 2));
    if (size != type_bytes.end()) {
      const std::size_t length = size->second * number(entry + 4, 4);
      tags[static_cast<int>(number(entry, 2))] = bytes.substr(length > 4 ? number(entry + 8, 4) : entry + 8, length);
    }
  }
  return tags;
}

template <typename T>
std::vector<T> Values(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

TEST_F(ExportTest, AGeoTiffShowsEveryPointWhereItLies) {
  const GeoTiffSummary summary = ExportGeoTiff(Map(), 0.0, File("map.tif"));
  EXPECT_EQ(summary.width_px, 3 * kTilePx);
  EXPECT_EQ(summary.height_px, 3 * kTilePx);
  EXPECT_FALSE(fs::exists(File("map.tif.part")));
  const auto tags = ReadTiffTags(ReadBytes(File("map.tif")));
  EXPECT_THAT(Values<double>(tags.at(33550)), ::testing::ElementsAre(kPixelM, kPixelM, 0.0));
  const std::vector<double> tiepoint = Values<double>(tags.at(33922));
  ASSERT_EQ(tiepoint.size(), 6U);
  const auto keys = Values<std::uint16_t>(tags.at(34735));
  ASSERT_EQ(keys.size(), 20U);
  EXPECT_EQ(keys[3], 4);  // number of keys
  EXPECT_THAT(std::vector<std::uint16_t>(keys.begin() + 8, keys.begin() + 12),
              ::testing::ElementsAre(1025, 0, 1, 1));  // pixel is area
  EXPECT_EQ(keys[14] + 1U, tags.at(34737).size()) << "the citation and its end";
  const cv::Mat image = cv::imread(File("map.tif").string(), cv::IMREAD_COLOR);
  ASSERT_EQ(image.size(), cv::Size(3 * kTilePx, 3 * kTilePx));
  for (const auto& [x, y] : {std::pair(-0.3, 0.4), {0.5, -0.9}, {-0.6, -0.2}, {0.85, 0.6}, {1.1, -1.1}}) {
    const int u = static_cast<int>((x - tiepoint[3]) / kPixelM);
    const int v = static_cast<int>((tiepoint[4] - y) / kPixelM);
    EXPECT_LE(cv::norm(image.at<cv::Vec3b>(v, u), ColorAt(x, y), cv::NORM_INF), 4.0) << x << " " << y;
  }
  const cv::Rect missing(0, 2 * kTilePx, kTilePx, kTilePx);
  EXPECT_EQ(cv::norm(image(missing), cv::NORM_INF), 0.0);
  const MosaicImage mosaic = ExportMosaic(Map(), 0.0);
  EXPECT_LE(cv::norm(image, mosaic.bgr, cv::NORM_INF), 2.0) << "the same pixels as in the image";
}

// The bits of the second image in a TIFF, which must be a mask of the first.
cv::Mat ReadTiffMask(const fs::path& file) {
  TIFF* tiff = TIFFOpen(file.c_str(), "r");
  EXPECT_EQ(TIFFNumberOfDirectories(tiff), 2);
  std::uint32_t width = 0, height = 0, type = 0;
  std::uint16_t photometric = 0;
  EXPECT_EQ(TIFFSetDirectory(tiff, 1), 1);
  EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &type), 1);
  EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric), 1);
  EXPECT_EQ(type, FILETYPE_MASK + 0U);
  EXPECT_EQ(photometric, PHOTOMETRIC_MASK);
  EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width), 1);
  EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height), 1);
  cv::Mat mask(static_cast<int>(height), static_cast<int>(width), CV_8UC1);
  std::vector<std::uint8_t> bits(static_cast<std::size_t>(TIFFTileSize(tiff)));
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (v % kTilePx == 0 && u % kTilePx == 0) {
        EXPECT_GT(TIFFReadTile(tiff, bits.data(), static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v), 0, 0),
                  0);
        for (int i = 0; i < kTilePx * kTilePx; ++i) {
          const bool set = (bits[static_cast<std::size_t>(i / 8)] >> (7 - i % 8) & 1) != 0;
          mask.at<std::uint8_t>(v + i / kTilePx, u + i % kTilePx) = set ? 255 : 0;
        }
      }
    }
  }
  TIFFClose(tiff);
  return mask;
}

TEST_F(ExportTest, FloorThatWasNotSurveyedIsNoDataInAGeoTiff) {
  ExportGeoTiff(Map(), 0.0, File("map.tif"));
  const cv::Mat mask = ReadTiffMask(File("map.tif"));
  ASSERT_EQ(mask.size(), cv::Size(3 * kTilePx, 3 * kTilePx));
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      const double x = -kTileM + (u + 0.5) * kPixelM;
      const double y = kTileM - (v + 0.5) * kPixelM;
      if (std::abs(x - 0.9) > 0.02) {  // JPEG blurs the edge
        ASSERT_EQ(mask.at<std::uint8_t>(v, u) != 0, ColorAt(x, y) != cv::Vec3b(0, 0, 0)) << x << " " << y;
      }
    }
  }
}

TEST_F(ExportTest, AMosaicEndsWhereTheFloorDoes) {
  for (const double resolution_m : {0.0, 0.007, 0.03}) {
    const MosaicImage mosaic = ExportMosaic(MapOfExtent({-0.2, 0.3, -0.5, 0.1}), resolution_m);
    const double step_m = mosaic.resolution_m;
    // The floor of the tiles is larger than the extent of this map, and tiles of the coarse level are twice as large.
    const double side_m = resolution_m > 2.0 * kPixelM ? 2.0 * kTileM : kTileM;
    EXPECT_NEAR(mosaic.extent.x_min, -side_m, 1e-9);
    EXPECT_NEAR(mosaic.extent.x_max, 0.9, 2.5 * step_m) << "no floor beyond";
    EXPECT_NEAR(mosaic.extent.y_max, side_m, 1e-9);
    EXPECT_NEAR(mosaic.extent.width_m(), mosaic.bgr.cols * step_m, 1e-9);
    for (const auto& [x, y] : {std::pair(-0.3, 0.4), {0.5, -0.9}, {-0.6, -0.2}, {0.81, 0.6}}) {
      const int u = static_cast<int>((x - mosaic.extent.x_min) / step_m);
      const int v = static_cast<int>((mosaic.extent.y_max - y) / mosaic.extent.height_m() * mosaic.bgr.rows);
      EXPECT_LE(cv::norm(mosaic.bgr.at<cv::Vec3b>(v, u), ColorAt(x, y), cv::NORM_INF), 5.0) << x << " " << y;
    }
  }
  const MosaicImage wide = ExportMosaic(MapOfExtent({-0.2, 1.11, -0.5, 0.1}), 0.0);
  EXPECT_NEAR(wide.extent.x_max, 1.11, 1e-9) << "all of the map's extent";
}

TEST_F(ExportTest, ACoarseGeoTiffTakesACoarseLevel) {
  const GeoTiffSummary summary = ExportGeoTiff(Map(), 0.03, File("map.tif"));
  EXPECT_EQ(summary.width_px, 2 * kTilePx);
  EXPECT_EQ(summary.resolution_m, 2.0 * kPixelM);
}

TEST_F(ExportTest, AFileThatCannotBeWrittenIsRefused) {
  EXPECT_ANY_THROW(ExportGeoTiff(Map(), 0.0, File("nowhere") / "map.tif"));
  EXPECT_THROW(ExportTiles(Map(), folder_.path()), InputError) << "not empty";
  EXPECT_THROW(WriteNav2Map(MakeOccupancyGrid(Map(), 0.05), File("map.txt")), InputError);
}

TEST_F(ExportTest, TilesAreThoseOfTheMap) {
  EXPECT_EQ(ExportTiles(Map(), File("tiles")), static_cast<std::int64_t>(tiles_.size()));
  for (const MosaicTile& tile : tiles_) {
    const fs::path file =
        File("tiles") / std::to_string(tile.id.z) / std::to_string(tile.id.x) / (std::to_string(tile.id.y) + ".jpg");
    EXPECT_EQ(ReadBinaryFile(file), tile.jpeg) << file;
  }
  EXPECT_THAT(ReadTextFile(File("tiles") / "metadata.json"), ::testing::HasSubstr("\"tile_px\": 64"));
}

TEST_F(ExportTest, MapServersSeeSurveyedFloorAsFree) {
  WriteNav2Map(MakeOccupancyGrid(Map(), 0.05), File("map.yaml"));
  const std::string yaml = ReadTextFile(File("map.yaml"));
  EXPECT_THAT(yaml, ::testing::HasSubstr("image: \"map.pgm\"\nmode: trinary\nresolution: 0.05\n"));
  double origin_x = 0.0;
  double origin_y = 0.0;
  ASSERT_EQ(std::sscanf(yaml.c_str() + yaml.find("origin"), "origin: [%lf, %lf, 0.0]", &origin_x, &origin_y), 2);
  double free_thresh = 0.0;
  ASSERT_EQ(std::sscanf(yaml.c_str() + yaml.find("free_thresh"), "free_thresh: %lf", &free_thresh), 1);
  const cv::Mat grid = cv::imread(File("map.pgm").string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(grid.type(), CV_8UC1);
  const auto at = [&](double x, double y) {
    return grid.at<std::uint8_t>(grid.rows - 1 - static_cast<int>((y - origin_y) / 0.05),
                                 static_cast<int>((x - origin_x) / 0.05));
  };
  EXPECT_EQ(at(0.83, 0.1), OccupancyGrid::kFree);
  EXPECT_EQ(at(0.97, 0.1), OccupancyGrid::kUnknown);
  EXPECT_EQ(at(-0.6, 0.6), OccupancyGrid::kFree);
  EXPECT_EQ(at(-0.6, -0.6), OccupancyGrid::kFree);
  EXPECT_EQ(at(-0.6, -0.7), OccupancyGrid::kUnknown) << "the missing tile";
  EXPECT_EQ(at(0.05, -1.25), OccupancyGrid::kFree);
  // As in Nav2's map_server: free below free_thresh.
  EXPECT_LT((255.0 - OccupancyGrid::kFree) / 255.0, free_thresh);
  EXPECT_GT((255.0 - OccupancyGrid::kUnknown) / 255.0, free_thresh);
}

TEST_F(ExportTest, ThePoseGraphWeighsErrorsAsTheLinksDo) {
  const std::vector<MapFrame> frames = Map().ReadFrames();
  const std::vector<MapLink> links = Map().ReadLinks();
  ASSERT_EQ(links.size(), 1U);
  std::istringstream text(FormatG2o(frames, links));
  std::string word;
  std::vector<Pose2> vertices;
  int edges = 0;
  int fixed = -1;
  while (text >> word) {
    int first = 0;
    double x = 0.0, y = 0.0, yaw = 0.0;
    if (word == "FIX") {
      text >> fixed;
    } else if (word == "VERTEX_SE2") {
      text >> first >> x >> y >> yaw;
      ASSERT_EQ(first, static_cast<int>(vertices.size()));
      vertices.emplace_back(x, y, yaw);
    } else {
      ASSERT_EQ(word, "EDGE_SE2");
      int second = 0;
      Eigen::Matrix3d information;
      text >> first >> second >> x >> y >> yaw;
      for (int row = 0; row < 3; ++row) {
        for (int column = row; column < 3; ++column) {
          text >> information(row, column);
          information(column, row) = information(row, column);
        }
      }
      const Pose2 measured(x, y, yaw);
      // g2o's error is measured^-1 * first^-1 * second; ours is the difference of (x, y, yaw).
      const Pose2 off(x + 3e-4, y - 2e-4, yaw + 1e-3);
      const Pose2 difference = measured.Inverse() * off;
      const Eigen::Vector3d g2o_error(difference.x(), difference.y(), difference.yaw());
      const Eigen::Vector3d our_error(3e-4, -2e-4, 1e-3);
      EXPECT_NEAR(g2o_error.dot(information * g2o_error) / our_error.dot(links[0].covariance.inverse() * our_error),
                  1.0, 1e-6);
      EXPECT_EQ(first, links[0].first);
      EXPECT_EQ(second, links[0].second);
      ++edges;
    }
  }
  EXPECT_EQ(edges, 1);
  EXPECT_EQ(fixed, 0);
  ASSERT_EQ(vertices.size(), frames.size());
  EXPECT_LT((vertices[1].translation() - frames[1].map_from_base.translation()).norm(), 1e-9);
  EXPECT_NEAR(vertices[1].yaw(), frames[1].map_from_base.yaw(), 1e-9);
}

}  // namespace
}  // namespace floorloc
