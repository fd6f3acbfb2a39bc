// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <memory>
#include <random>

#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MakeContent;
using testing_map::ReadBytes;
using testing_map::SameKeypoints;
using testing_map::TemporaryFolder;
using testing_map::WriteBytes;
using testing_map::WriteMap;

class MapDamageTest : public ::testing::Test {
 protected:
  MapDamageTest() {
    WriteMap(file_, MakeContent());
    bytes_ = ReadBytes(file_);
    original_ = MapDatabase(file_).ReadMap();
  }

  void RunSql(const std::string& sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &handle), SQLITE_OK);
    char* message = nullptr;
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
    sqlite3_close(handle);
  }
  std::string ErrorOfReading() const {
    return ErrorOf([this] { MapDatabase(file_).ReadMap(); });
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
  std::string bytes_;
  FloorMap original_;
};

TEST_F(MapDamageTest, FlippedBytesAreFoundOrHarmless) {
  std::mt19937 random(1);
  int found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = bytes_;
    const std::size_t place = random() % damaged.size();
    damaged[place] = static_cast<char>(damaged[place] ^ static_cast<char>(1 + random() % 255));
    WriteBytes(file_, damaged);
    try {
      const MapDatabase database(file_);
      const FloorMap map = database.ReadMap();
      EXPECT_TRUE(SameKeypoints(map.keypoints, original_.keypoints)) << "byte " << place;
      database.VerifyContent();
      EXPECT_EQ(map.info.camera().floor.base_from_pixel, original_.info.camera().floor.base_from_pixel)
          << "byte " << place;
      EXPECT_EQ(map.info.camera().camera.fx, original_.info.camera().camera.fx) << "byte " << place;
      EXPECT_EQ(map.info.area_m2, original_.info.area_m2) << "byte " << place;
      EXPECT_EQ(database.ReadFrames().size(), 2U) << "byte " << place;
      EXPECT_EQ(database.ReadLinks().size(), 1U) << "byte " << place;
    } catch (const MapError&) {
      ++found;
    }
  }
  EXPECT_GT(found, 150);  // the rest hit unused bytes of the file, or its names and reports
}

TEST_F(MapDamageTest, CutOffFilesAreRefused) {
  for (int i = 0; i < 30; ++i) {
    const std::size_t length = bytes_.size() * static_cast<std::size_t>(i) / 30;
    WriteBytes(file_, bytes_.substr(0, length));
    EXPECT_THAT(ErrorOfReading(), HasSubstr("m.floormap")) << length << " bytes of " << bytes_.size();
  }
}

TEST_F(MapDamageTest, DamagedContentSaysWhatToDo) {
  const std::vector<std::string> damages = {
      "UPDATE keypoint_tile SET position = zeroblob(length(position))",
      "UPDATE keypoint_tile SET position = zeroblob(length(position) - 4)",
      "UPDATE keypoint_tile SET descriptor = zeroblob(7)",
      "UPDATE keypoint_tile SET count = count + 1",
      "UPDATE keypoint_tile SET count = -1",
      "UPDATE keypoint_tile SET count = 9000000000000",
      "UPDATE keypoint_tile SET checksum = checksum + 1",
      "UPDATE map SET descriptor_length = 33",
      "UPDATE map SET descriptor_length = 1000000000",
      "UPDATE map SET keypoint_tile_m = 0",
      "UPDATE map SET mosaic_tile_px = 0",
      "UPDATE map SET mosaic_max_zoom = 63",
      "UPDATE map SET resolution_m = -1",
      "UPDATE extractor_parameter SET value = '1e9' WHERE name = 'levels'",
      "UPDATE extractor_parameter SET value = 'surff' WHERE name = 'type'",
      "DELETE FROM extractor_parameter WHERE name = 'levels'",
      "DELETE FROM map",
      "DELETE FROM camera",
      "UPDATE camera SET homography = zeroblob(72)",
      "UPDATE camera SET homography = zeroblob(71)",
      "UPDATE camera SET distortion_model = 'thin_prism'",
      "UPDATE camera SET width_px = 0",
      "DROP TABLE keypoint_tile",
      "DROP TABLE camera",
  };
  for (const std::string& damage : damages) {
    WriteBytes(file_, bytes_);
    RunSql(damage);
    const std::string error = ErrorOfReading();
    EXPECT_THAT(error, HasSubstr("m.floormap")) << damage;
    EXPECT_THAT(error, HasSubstr("restore it from a copy or build it again")) << damage;
  }
}

TEST_F(MapDamageTest, VerifyFindsWhatReadingDoesNotNeed) {
  const std::vector<std::string> damages = {"UPDATE frame SET x = x + 0.001 WHERE id = 1",
                                            "DELETE FROM mosaic_tile WHERE z = 2 AND x = 0",
                                            "UPDATE mosaic_tile SET jpeg = zeroblob(length(jpeg)) WHERE z = 2",
                                            "DELETE FROM keypoint_tile WHERE x = 0",
                                            "UPDATE map SET x_max = x_max + 1",
                                            "UPDATE map SET content_version = 'x'",
                                            "UPDATE camera SET fx = fx + 1"};
  for (const std::string& damage : damages) {
    WriteBytes(file_, bytes_);
    RunSql(damage);
    EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("is damaged")) << damage;
  }
}

TEST_F(MapDamageTest, ADamagedTileIsRefusedAlone) {
  RunSql("UPDATE mosaic_tile SET jpeg = zeroblob(10) WHERE z = 2 AND x = 0");
  const MapDatabase database(file_);
  EXPECT_NO_THROW(database.ReadMap());
  EXPECT_NE(database.ReadMosaicTile({2, 1, -2}), std::nullopt);
  EXPECT_THAT(ErrorOf([&] { database.ReadMosaicTile({2, 0, -2}); }), HasSubstr("is damaged"));
}

TEST_F(MapDamageTest, FilesThatAreNoMapsAreRefused) {
  const auto error_of = [&](const std::filesystem::path& file) {
    return ErrorOf([&] { const MapDatabase database(file); });
  };
  EXPECT_THAT(error_of(folder_.path() / "missing.floormap"), HasSubstr("missing.floormap does not exist"));
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("is no file"));
  for (const std::string& content : {std::string(), std::string("timestamp,filename\n"), std::string(5000, 'x')}) {
    WriteBytes(file_, content);
    EXPECT_THAT(error_of(file_), HasSubstr("is not a floorloc map; give a .floormap file")) << content.substr(0, 10);
  }
}

TEST_F(MapDamageTest, ADatabaseOfAnotherProgramIsRefused) {
  RunSql("PRAGMA application_id = 1196444487");
  EXPECT_THAT(ErrorOfReading(), HasSubstr("is not a floorloc map"));
}

TEST_F(MapDamageTest, ANewerFormatIsRefusedByName) {
  RunSql("PRAGMA user_version = 3");
  const std::string error = ErrorOfReading();
  EXPECT_THAT(error, HasSubstr("has format version 3"));
  EXPECT_THAT(error, HasSubstr("reads version 2"));
  EXPECT_THAT(error, HasSubstr("build the map again"));
}

// A map comes from outside: views and triggers in it must not run.
TEST_F(MapDamageTest, ForeignSchemaIsNotTrusted) {
  RunSql("ALTER TABLE keypoint_tile RENAME TO hidden; CREATE VIEW keypoint_tile AS SELECT * FROM hidden");
  try {
    EXPECT_TRUE(SameKeypoints(MapDatabase(file_).ReadMap().keypoints, original_.keypoints));
  } catch (const MapError& error) {
    EXPECT_THAT(error.what(), HasSubstr("m.floormap"));
  }
}

}  // namespace
}  // namespace floorloc
