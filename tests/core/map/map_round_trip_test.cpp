// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "core/map/extractor_parameters.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::TemporaryFolder;
using testing_map::WriteMap;

void ExpectSame(const RectM& a, const RectM& b) {
  EXPECT_EQ(std::tie(a.x_min, a.x_max, a.y_min, a.y_max), std::tie(b.x_min, b.x_max, b.y_min, b.y_max));
}

void ExpectSame(const ExtractorOptions& a, const ExtractorOptions& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.max_keypoints, b.max_keypoints);
  EXPECT_EQ(a.cell_px, b.cell_px);
  EXPECT_EQ(a.levels, b.levels);
  EXPECT_EQ(a.scale_factor, b.scale_factor);
  EXPECT_EQ(a.threshold, b.threshold);
  EXPECT_EQ(a.normalize_radius_px, b.normalize_radius_px);
  EXPECT_EQ(a.smooth_sigma_px, b.smooth_sigma_px);
}

void ExpectSame(const FloorCamera& a, const FloorCamera& b) {
  EXPECT_EQ(a.camera.name, b.camera.name);
  EXPECT_EQ(a.camera.width_px, b.camera.width_px);
  EXPECT_EQ(a.camera.height_px, b.camera.height_px);
  EXPECT_EQ(std::tie(a.camera.fx, a.camera.fy, a.camera.cx, a.camera.cy),
            std::tie(b.camera.fx, b.camera.fy, b.camera.cx, b.camera.cy));
  EXPECT_EQ(a.camera.distortion_model, b.camera.distortion_model);
  EXPECT_EQ(a.camera.distortion, b.camera.distortion);
  EXPECT_EQ(a.floor.base_from_pixel, b.floor.base_from_pixel);
  ExpectSame(a.floor.roi, b.floor.roi);
  EXPECT_EQ(a.floor.resolution_m, b.floor.resolution_m);
  EXPECT_EQ(a.camera.sigma_px, b.camera.sigma_px);
  EXPECT_EQ(a.floor.offset_sigma_m, b.floor.offset_sigma_m);
}

// The file orders keypoints by tile, so they are identified by their unique response.
void ExpectSame(const MapKeypoints& written, const MapKeypoints& read) {
  ASSERT_EQ(read.size(), written.size());
  ASSERT_EQ(read.observations.size(), written.size());
  ASSERT_EQ(read.descriptors.rows, written.descriptors.rows);
  ASSERT_EQ(read.descriptors.type(), written.descriptors.type());
  std::map<float, std::size_t> by_response;
  for (std::size_t i = 0; i < written.size(); ++i) {
    by_response[written.keypoints[i].response] = i;
  }
  ASSERT_EQ(by_response.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const std::size_t w = by_response.at(read.keypoints[i].response);
    EXPECT_NEAR(read.keypoints[i].x_m, written.keypoints[w].x_m, 3e-7);  // stored relative to the tile's corner
    EXPECT_NEAR(read.keypoints[i].y_m, written.keypoints[w].y_m, 3e-7);
    EXPECT_EQ(read.keypoints[i].angle_rad, written.keypoints[w].angle_rad);
    EXPECT_EQ(read.keypoints[i].size_m, written.keypoints[w].size_m);
    EXPECT_EQ(read.observations[i], written.observations[w]);
    EXPECT_EQ(read.distinctiveness[i], written.distinctiveness[w]);
    EXPECT_EQ(read.last_survey[i], written.last_survey[w]);
    EXPECT_EQ(
        cv::norm(read.descriptors.row(static_cast<int>(i)), written.descriptors.row(static_cast<int>(w)), cv::NORM_INF),
        0.0);
  }
}

class MapRoundTrip : public ::testing::TestWithParam<std::tuple<DescriptorType, DistortionModel>> {};

TEST_P(MapRoundTrip, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const MapContent content = MakeContent(std::get<0>(GetParam()), std::get<1>(GetParam()));
  const std::string version = WriteMap(folder.path() / "hall.floormap", content);
  const MapDatabase database(folder.path() / "hall.floormap");
  database.VerifyContent();
  const FloorMap map = database.ReadMap();

  EXPECT_EQ(map.info.format_version, 3);
  EXPECT_EQ(map.info.builder_version, content.info.builder_version);
  EXPECT_EQ(map.info.id, content.info.id);
  EXPECT_EQ(map.info.content_version, version);
  EXPECT_EQ(map.info.name, content.info.name);
  EXPECT_EQ(map.info.created, content.info.created);
  EXPECT_EQ(map.info.resolution_m, content.mosaic.resolution_m);
  ExpectSame(map.info.extent, content.info.extent);
  EXPECT_EQ(map.info.area_m2, content.info.area_m2);
  ExpectSame(map.info.extractor, content.info.extractor);
  ASSERT_EQ(map.info.cameras.size(), 2U);
  ExpectSame(map.info.camera(), content.info.camera());
  ExpectSame(map.info.cameras[1], content.info.cameras[1]);
  ASSERT_EQ(map.info.given_cameras.size(), 2U);
  ExpectSame(map.info.given_cameras[0], content.info.given_cameras[0]);
  ExpectSame(map.info.given_cameras[1], content.info.given_cameras[1]);
  ASSERT_EQ(map.info.parents.size(), 2U);
  EXPECT_EQ(map.info.parents[1].relation, "merges");
  EXPECT_EQ(map.info.parents[1].id, content.info.parents[1].id);
  EXPECT_EQ(map.info.parents[1].content_version, content.info.parents[1].content_version);
  EXPECT_EQ(map.info.surveys_json, content.info.surveys_json);
  EXPECT_EQ(map.info.report_json, content.info.report_json);
  EXPECT_EQ(map.mosaic.tile_px, content.mosaic.tile_px);
  EXPECT_EQ(map.mosaic.max_zoom, content.mosaic.max_zoom);
  EXPECT_EQ(map.mosaic.resolution_m, content.mosaic.resolution_m);
  ExpectSame(content.keypoints, map.keypoints);
}

INSTANTIATE_TEST_SUITE_P(Kinds, MapRoundTrip,
                         ::testing::Combine(::testing::Values(DescriptorType::kBinary, DescriptorType::kFloat),
                                            ::testing::Values(DistortionModel::kPlumbBob,
                                                              DistortionModel::kRationalPolynomial,
                                                              DistortionModel::kEquidistant)),
                         [](const auto& name) {
                           return std::string(ToString(std::get<0>(name.param))) + "_" +
                                  ToString(std::get<1>(name.param));
                         });

TEST(MapTest, FramesReadBackInOrder) {
  const TemporaryFolder folder;
  const MapContent content = MakeContent();
  WriteMap(folder.path() / "m.floormap", content);
  const std::vector<MapFrame> frames = MapDatabase(folder.path() / "m.floormap").ReadFrames();
  ASSERT_EQ(frames.size(), content.frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].stamp_ns, content.frames[i].stamp_ns);
    EXPECT_EQ(frames[i].filename, content.frames[i].filename);
    EXPECT_EQ(frames[i].map_from_base.x(), content.frames[i].map_from_base.x());
    EXPECT_EQ(frames[i].map_from_base.y(), content.frames[i].map_from_base.y());
    EXPECT_EQ(frames[i].map_from_base.yaw(), content.frames[i].map_from_base.yaw());
  }
}

TEST(MapTest, MosaicTilesReadBack) {
  const TemporaryFolder folder;
  const MapContent content = MakeContent();
  WriteMap(folder.path() / "m.floormap", content);
  const MapDatabase database(folder.path() / "m.floormap");
  for (const MosaicTile& tile : content.tiles) {
    EXPECT_EQ(database.ReadMosaicTile(tile.id), tile.jpeg);
  }
  EXPECT_EQ(database.ReadMosaicTile({0, 5, 5}), std::nullopt);
  EXPECT_EQ(database.ReadMosaicTile({-1, 0, 0}), std::nullopt);
  EXPECT_THAT(database.ListMosaicTiles(1),
              ::testing::ElementsAre(TileId{1, -1, -1}, TileId{1, 0, -1}, TileId{1, 1, -1}));
  EXPECT_TRUE(database.ListMosaicTiles(9).empty());
}

TEST(MapTest, EmptyMapReadsBack) {
  const TemporaryFolder folder;
  MapContent content = MakeContent();
  content.frames.clear();
  content.links.clear();
  content.tiles.clear();
  content.keypoints = testing_map::RandomKeypoints(0, DescriptorType::kBinary, 1);
  WriteMap(folder.path() / "m.floormap", content);
  const MapDatabase database(folder.path() / "m.floormap");
  database.VerifyContent();
  EXPECT_EQ(database.ReadMap().keypoints.size(), 0U);
  EXPECT_TRUE(database.ReadFrames().empty());
}

TEST(MapTest, EveryExtractorParameterReadsBack) {
  ExtractorOptions options;
  options.scale_factor = 1.1000000000000001;
  options.threshold = 1e-300;
  ExpectSame(FromParameters(ToParameters(options)), options);
  for (const auto& [name, value] : ToParameters(options)) {
    auto without = ToParameters(options);
    without.erase(name);
    EXPECT_THROW(FromParameters(without), std::invalid_argument) << name;
    auto broken = ToParameters(options);
    broken[name] = "x" + value;
    EXPECT_THROW(FromParameters(broken), std::invalid_argument) << name;
  }
  auto newer = ToParameters(options);
  newer["upright"] = "1";
  EXPECT_THROW(FromParameters(newer), std::invalid_argument);
}

TEST(ContentVersionTest, WhereAMapIsFromDoesNotCount) {
  const TemporaryFolder folder;
  const MapContent content = MakeContent();
  MapContent renamed = content;
  renamed.info.name = "other";
  renamed.info.id = "another";
  renamed.info.parents[0].id = "an id of chance";
  renamed.info.builder_version = "10.0.0";
  renamed.info.created = "2030-01-01T00:00:00Z";
  EXPECT_EQ(WriteMap(folder.path() / "a.floormap", content), WriteMap(folder.path() / "b.floormap", renamed));
}

TEST(ContentVersionTest, EveryChangeOfTheContentCounts) {
  const TemporaryFolder folder;
  const std::string version = WriteMap(folder.path() / "m.floormap", MakeContent());
  const std::map<std::string, std::function<void(MapContent&)>> changes = {
      {"position", [](MapContent& c) { c.keypoints.keypoints[7].x_m += 1e-5F; }},
      {"angle", [](MapContent& c) { c.keypoints.keypoints[7].angle_rad += 1e-5F; }},
      {"observations", [](MapContent& c) { ++c.keypoints.observations[7]; }},
      {"descriptor", [](MapContent& c) { c.keypoints.descriptors.at<std::uint8_t>(7, 31) ^= 1; }},
      {"frame", [](MapContent& c) { c.frames[1].map_from_base = Pose2(0.1, 0.2, -3.0); }},
      {"gain", [](MapContent& c) { c.frames[1].gain = 0.5; }},
      {"odometry", [](MapContent& c) { c.frames[1].odom_from_base.reset(); }},
      {"link", [](MapContent& c) { c.links[0].covariance(2, 2) = 4e-6; }},
      {"distinctiveness", [](MapContent& c) { ++c.keypoints.distinctiveness[7]; }},
      {"last survey", [](MapContent& c) { ++c.keypoints.last_survey[7]; }},
      {"second camera", [](MapContent& c) { c.info.cameras[1].camera.fx += 1e-9; }},
      {"tile", [](MapContent& c) { c.tiles[3].jpeg[17] ^= 1; }},
      {"extractor", [](MapContent& c) { c.info.extractor.threshold = 5.0; }},
      {"camera", [](MapContent& c) { c.info.cameras[0].camera.fx += 1e-9; }},
      {"distortion", [](MapContent& c) { c.info.cameras[0].camera.distortion[0] += 1e-9; }},
      {"extent", [](MapContent& c) { c.info.extent.x_max += 1e-9; }},
      {"no odometry is not odometry zero", [](MapContent& c) { c.frames[0].odom_from_base = Pose2(); }},
      {"report", [](MapContent& c) { c.info.report_json = R"({"frames":3})"; }},
      {"surveys", [](MapContent& c) { c.info.surveys_json = "[]"; }},
      {"camera's name", [](MapContent& c) { c.info.cameras[1].camera.name = "rear"; }},
      {"relation", [](MapContent& c) { c.info.parents[0].relation = "extends"; }},
      {"parent", [](MapContent& c) { c.info.parents[1].content_version = "third version"; }},
      {"no parents", [](MapContent& c) { c.info.parents.clear(); }},
  };
  for (const auto& [name, change] : changes) {
    MapContent content = MakeContent();
    change(content);
    EXPECT_NE(WriteMap(folder.path() / "m.floormap", content), version) << name;
  }
}

TEST(KeypointOriginTest, IsNearTheFloorInWholeKilometres) {
  EXPECT_EQ(KeypointOrigin({-3.0, 900.0, -40.0, 2.0}), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(KeypointOrigin({691'200.0, 691'500.0, 5'336'700.0, 5'336'900.0}), Eigen::Vector2d(691e3, 5337e3));
  EXPECT_EQ(KeypointOrigin({-7400.0, -7300.0, 400.0, 450.0}), Eigen::Vector2d(-7000.0, 0.0));
}

// Kept as float32 in the map frame they would be off by a quarter of a metre.
TEST(KeypointOriginTest, PositionsAreExactFarFromTheMapFramesOrigin) {
  const TemporaryFolder folder;
  MapContent content = MakeContent();
  const Eigen::Vector2d far(691'999.5, 5'336'789.25);
  content.info.extent = {far.x() - 1.5, far.x() + 1.5, far.y() - 0.7, far.y() + 1.3};
  content.keypoints.origin_m = far;
  for (MapFrame& frame : content.frames) {
    frame.map_from_base = Pose2(far.x(), far.y(), 0.0) * frame.map_from_base;
  }
  content.tiles.clear();
  WriteMap(folder.path() / "hall.floormap", content);
  const MapKeypoints read = MapDatabase(folder.path() / "hall.floormap").ReadMap().keypoints;
  ASSERT_EQ(read.size(), content.keypoints.size());
  EXPECT_NE(read.origin_m, far);
  std::map<float, Eigen::Vector2d> written;
  for (std::size_t i = 0; i < content.keypoints.size(); ++i) {
    written[content.keypoints.keypoints[i].response] = content.keypoints.PositionInMap(i);
  }
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_LT((read.PositionInMap(i) - written.at(read.keypoints[i].response)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace floorloc
