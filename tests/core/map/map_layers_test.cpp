// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_contract.h"
#include "tests/core/map/map_damages.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MakeContent;
using testing_map::RunSql;

class MapLayersTest : public ::testing::Test {
 protected:
  MapLayersTest() { version_ = WriteMap(file_, MakeContent()); }

  // Changes the file as another version of the program would have written it.
  void Rewrite(const std::string& sql) const {
    RunSql(file_, sql);
    const std::string content = ComputeContentVersion(SqliteConnection(file_, SqliteConnection::Mode::kReadOnly));
    RunSql(file_, "UPDATE map SET content_version = '" + content + "'");
  }
  void AddLayer(const std::string& name, int version, bool required) const {
    Rewrite("CREATE TABLE " + name + " (x REAL); INSERT INTO layer VALUES ('" + name + "', " + std::to_string(version) +
            ", " + (required ? "1" : "0") + ", '" + std::string(64, 'a') + "')");
  }
  MapError::Kind KindOfError() const {
    try {
      const MapDatabase database(file_);
    } catch (const MapError& error) {
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return MapError::Kind::kOther;
  }

  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
  std::string version_;
};

TEST_F(MapLayersTest, AMapNamesItsLayers) {
  const MapInfo info = MapDatabase(file_).ReadInfo();
  EXPECT_EQ(info.format_version, 3);
  ASSERT_EQ(info.layers.size(), 4U);
  EXPECT_EQ(info.layers[0].name, "calibration");
  EXPECT_EQ(info.layers[1].name, "frames");
  EXPECT_EQ(info.layers[2].name, "keypoints");
  EXPECT_EQ(info.layers[3].name, "mosaic");
  for (const MapFileLayer& layer : info.layers) {
    EXPECT_EQ(layer.version, 1);
    EXPECT_TRUE(layer.known);
    EXPECT_EQ(layer.required, layer.name != "calibration");
  }
}

TEST_F(MapLayersTest, AnUnknownOptionalLayerIsLeftAlone) {
  AddLayer("zones", 7, false);
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadMap().info;
  ASSERT_EQ(info.layers.size(), 5U);
  EXPECT_EQ(info.layers[4].name, "zones");
  EXPECT_EQ(info.layers[4].version, 7);
  EXPECT_FALSE(info.layers[4].known);
  EXPECT_NE(info.content_version, version_) << "a layer is content";
}

TEST_F(MapLayersTest, AnUnknownRequiredLayerIsRefused) {
  AddLayer("walls", 2, true);
  EXPECT_THAT(ErrorOf([this] { const MapDatabase database(file_); }),
              AllOf(HasSubstr("m.floormap has the layer 'walls' in version 2"), HasSubstr("use a newer version")));
  EXPECT_EQ(KindOfError(), MapError::Kind::kUnsupported);
}

TEST_F(MapLayersTest, ANewerVersionOfANeededLayerIsRefused) {
  RunSql(file_, "UPDATE layer SET version = 2, required = 0 WHERE name = 'mosaic'");
  EXPECT_THAT(ErrorOf([this] { const MapDatabase database(file_); }), HasSubstr("the layer 'mosaic' in version 2"));
  EXPECT_EQ(KindOfError(), MapError::Kind::kUnsupported);
}

// Maps of before the layer existed: what the calibrations are worth and what they were is unknown.
TEST_F(MapLayersTest, AMapWithoutCalibrationsIsRead) {
  Rewrite("DROP TABLE calibration; DELETE FROM layer WHERE name = 'calibration'");
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadMap().info;
  EXPECT_TRUE(info.given_cameras.empty());
  ASSERT_EQ(info.cameras.size(), 2U);
  EXPECT_EQ(info.cameras[0].camera.sigma_px, 0.0);
  EXPECT_EQ(info.cameras[0].floor.offset_sigma_m, 0.0);
}

// It is optional, so its table may have become another one.
TEST_F(MapLayersTest, ANewerVersionOfTheCalibrationsIsLeftAlone) {
  Rewrite("UPDATE layer SET version = 2 WHERE name = 'calibration'; ALTER TABLE calibration DROP COLUMN given_fx");
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadMap().info;
  ASSERT_EQ(info.layers[0].name, "calibration");
  EXPECT_FALSE(info.layers[0].known);
  EXPECT_TRUE(info.given_cameras.empty());
}

TEST_F(MapLayersTest, ACalibrationSaysWhatIsWrongWithIt) {
  RunSql(file_, "UPDATE calibration SET given_homography = zeroblob(72) WHERE survey = 1");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).ReadMap(); }),
              HasSubstr("is damaged (calibration 1: homography is singular)"));
}

TEST_F(MapLayersTest, ADamagedTableOfLayersIsRefused) {
  const std::string bytes = testing_map::ReadBytes(file_);
  for (const std::string damage : {"DELETE FROM layer WHERE name = 'frames'", "DELETE FROM layer", "DROP TABLE layer",
                                   "UPDATE layer SET version = 0", "UPDATE layer SET version = 'new'",
                                   "UPDATE layer SET required = 2", "UPDATE layer SET content_hash = ''"}) {
    testing_map::WriteBytes(file_, bytes);
    RunSql(file_, damage);
    EXPECT_THAT(ErrorOf([this] { const MapDatabase database(file_); }), HasSubstr("is damaged")) << damage;
  }
}

TEST_F(MapLayersTest, VerifySaysWhichLayerIsDamaged) {
  RunSql(file_, "UPDATE link SET inliers = inliers + 1");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("its layer 'frames'"));
  RunSql(file_, "UPDATE link SET inliers = inliers - 1");
  MapDatabase(file_).VerifyContent();
  RunSql(file_, "UPDATE layer SET content_hash = replace(hex(zeroblob(32)), '0', 'f') WHERE name = 'mosaic'");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("its layer 'mosaic'"));
}

// A real map of format version 2, written by floorloc before layers existed.
class Version2MapTest : public ::testing::Test {
 protected:
  Version2MapTest() {
    std::filesystem::copy_file(std::filesystem::path(FLOORLOC_TEST_DATA) / "version_2.floormap", file_);
  }

  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "old.floormap";
};

TEST_F(Version2MapTest, IsReadAndVerified) {
  const MapDatabase database(file_);
  database.VerifyContent();
  const FloorMap map = database.ReadMap();
  EXPECT_EQ(map.info.format_version, 2);
  EXPECT_EQ(map.info.content_version, "2c79d754869b150b1b27b3c48bd8ce15469004df6ad28cfe71e38f4c6b2ee166");
  EXPECT_EQ(map.info.layers.size(), 3U);
  EXPECT_EQ(map.keypoints.size(), 638U);
  EXPECT_EQ(database.ReadFrames().size(), 8U);
  EXPECT_EQ(database.ReadLinks().size(), 16U);
}

// The content version of format 2 covers the columns that affect localization.
TEST_F(Version2MapTest, DamageIsFound) {
  for (const std::string damage : {"UPDATE frame SET x = x + 0.001 WHERE id = 1", "DELETE FROM mosaic_tile WHERE z = 0",
                                   "UPDATE link SET inliers = inliers + 1", "UPDATE camera SET fx = fx + 1"}) {
    std::filesystem::copy_file(std::filesystem::path(FLOORLOC_TEST_DATA) / "version_2.floormap", file_,
                               std::filesystem::copy_options::overwrite_existing);
    RunSql(file_, damage);
    EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("is damaged")) << damage;
  }
}

}  // namespace
}  // namespace floorloc
