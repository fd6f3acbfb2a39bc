// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "tests/core/map/map_damages.h"
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

  void RunSql(const std::string& sql) const { testing_map::RunSql(file_, sql); }
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
  EXPECT_GT(found, 150);  // the other changes hit unused bytes, names or reports
}

TEST_F(MapDamageTest, CutOffFilesAreRefused) {
  for (int i = 0; i < 30; ++i) {
    const std::size_t length = bytes_.size() * static_cast<std::size_t>(i) / 30;
    WriteBytes(file_, bytes_.substr(0, length));
    EXPECT_THAT(ErrorOfReading(), HasSubstr("m.floormap")) << length << " bytes of " << bytes_.size();
  }
}

TEST_F(MapDamageTest, DamagedContentSaysWhatToDo) {
  for (const std::string& damage : testing_map::FatalDamages()) {
    WriteBytes(file_, bytes_);
    RunSql(damage);
    const std::string error = ErrorOfReading();
    EXPECT_THAT(error, HasSubstr("m.floormap")) << damage;
    EXPECT_THAT(error, HasSubstr("restore it from a copy or build it again")) << damage;
  }
}

TEST_F(MapDamageTest, OtherDamageIsRefusedOrHarmless) {
  for (const std::string& damage : testing_map::OtherDamages()) {
    WriteBytes(file_, bytes_);
    RunSql(damage);
    try {
      const MapDatabase database(file_);
      const FloorMap map = database.ReadMap();
      for (const MapFrame& frame : database.ReadFrames()) {
        EXPECT_LT(static_cast<std::size_t>(frame.survey), map.info.cameras.size()) << damage;
      }
    } catch (const MapError& error) {
      EXPECT_EQ(error.kind(), MapError::Kind::kDamaged) << damage;
    }
  }
}

// Valid checksums do not protect against deliberate changes.
TEST_F(MapDamageTest, KeypointsThatNoneCanHaveAreRefused) {
  const std::vector<std::function<void(MapKeypoints&)>> changes = {
      [](MapKeypoints& k) { k.last_survey[5] = 2; },
      [](MapKeypoints& k) { k.keypoints[5].angle_rad = std::numeric_limits<float>::infinity(); },
      [](MapKeypoints& k) { k.keypoints[5].angle_rad = 1e30F; },
      [](MapKeypoints& k) { k.keypoints[5].size_m = -1.0F; },
      [](MapKeypoints& k) { k.keypoints[5].response = std::numeric_limits<float>::quiet_NaN(); },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    testing_map::MapContent content = MakeContent();
    changes[i](content.keypoints);
    WriteMap(file_, content);
    EXPECT_THAT(ErrorOfReading(), HasSubstr("is damaged (keypoint tile")) << i;
  }
  testing_map::MapContent content = MakeContent(DescriptorType::kFloat);
  content.keypoints.descriptors.at<float>(7, 3) = std::numeric_limits<float>::quiet_NaN();
  WriteMap(file_, content);
  EXPECT_THAT(ErrorOfReading(), HasSubstr("is damaged (keypoint tile"));
}

// Such keypoints would be matched with features of another extractor.
TEST_F(MapDamageTest, DescriptorsOfAnotherExtractorAreRefused) {
  for (const std::string type : {"brisk", "akaze", "sift", "surf"}) {
    WriteBytes(file_, bytes_);
    RunSql("UPDATE extractor_parameter SET value = '" + type + "' WHERE name = 'type'");
    EXPECT_THAT(ErrorOfReading(), HasSubstr("descriptors are 32 bytes each, those of its extractor '" + type)) << type;
  }
  WriteBytes(file_, bytes_);
  RunSql("UPDATE map SET descriptor_type = 'float', descriptor_length = 8");  // the same number of bytes
  EXPECT_THAT(ErrorOfReading(), HasSubstr("descriptors are 8 numbers each"));
}

TEST_F(MapDamageTest, TheSentenceNamesTableRowAndColumn) {
  RunSql("UPDATE frame SET survey = 1000000 WHERE id = 1");
  EXPECT_EQ(ErrorOf([this] { MapDatabase(file_).ReadFrames(); }),
            file_.string() +
                " is damaged (frame 1: survey is 1000000, not within 0 to 1); restore it from a copy or "
                "build it again");
}

TEST_F(MapDamageTest, VerifyFindsWhatReadingDoesNotNeed) {
  const std::vector<std::string> damages = {"UPDATE frame SET x = x + 0.001 WHERE id = 1",
                                            "DELETE FROM mosaic_tile WHERE z = 2 AND x = 0",
                                            "UPDATE mosaic_tile SET jpeg = zeroblob(length(jpeg)) WHERE z = 2",
                                            "DELETE FROM keypoint_tile WHERE x = 0",
                                            "UPDATE map SET x_max = x_max + 1",
                                            "UPDATE map SET content_version = replace(hex(zeroblob(32)), '0', 'f')",
                                            "UPDATE map SET report_json = '{\"frames\":3}'",
                                            "UPDATE map SET surveys_json = '[]'",
                                            "UPDATE parent SET content_version = 'another'",
                                            "DELETE FROM parent",
                                            "UPDATE camera SET name = 'rear'",
                                            "UPDATE link SET inliers = inliers + 1",
                                            "UPDATE frame SET odom_x = 0, odom_y = 0, odom_yaw = 0 WHERE id = 0",
                                            "UPDATE camera SET fx = fx + 1",
                                            "UPDATE calibration SET sigma_px = sigma_px + 0.1",
                                            "UPDATE calibration SET given_fx = given_fx + 0.001"};
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
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("is not a file"));
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
  RunSql("PRAGMA user_version = 4");
  const std::string error = ErrorOfReading();
  EXPECT_THAT(error, HasSubstr("has format version 4"));
  EXPECT_THAT(error, HasSubstr("reads versions 2 to 3"));
  EXPECT_THAT(error, HasSubstr("build the map again"));
}

// Map files are untrusted: their views and triggers must not run.
TEST_F(MapDamageTest, ForeignSchemaIsNotTrusted) {
  for (const std::string schema :
       {"ALTER TABLE keypoint_tile RENAME TO hidden; CREATE VIEW keypoint_tile AS SELECT * FROM hidden",
        "CREATE TRIGGER t AFTER UPDATE ON map BEGIN DELETE FROM frame; END",
        "CREATE VIRTUAL TABLE words USING fts5(word)"}) {
    WriteBytes(file_, bytes_);
    RunSql(schema);
    EXPECT_THAT(ErrorOfReading(), HasSubstr("holds more than tables")) << schema;
  }
}

}  // namespace
}  // namespace floorloc
