// SPDX-License-Identifier: Apache-2.0
#include "core/map/floor_texture_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_layers.h"
#include "tests/core/map/map_damages.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::RunSql;

// A map whose second survey has a model of its floor's texture.
class FloorTextureTableTest : public ::testing::Test {
 protected:
  FloorTextureTableTest() {
    texture_.blocks = 120;
    texture_.mean << -3.5, 0.1, -0.2, -0.4, -1.2;
    texture_.covariance = MapFloorTexture::Covariance::Constant(1e-3);
    texture_.covariance.diagonal() << 0.01, 0.02, 0.03, 0.04, 0.05;
    content_.info.floor_textures = {{}, texture_};
    version_ = WriteMap(file_, content_);
  }

  MapContent content_ = MakeContent();
  MapFloorTexture texture_;
  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
  std::string version_;
};

TEST_F(FloorTextureTableTest, WhatIsWrittenIsRead) {
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadInfo();
  ASSERT_EQ(info.floor_textures.size(), 2U);
  EXPECT_EQ(info.floor_textures[0].blocks, 0);
  EXPECT_EQ(info.floor_textures[1].blocks, 120);
  EXPECT_EQ(info.floor_textures[1].mean, texture_.mean);
  EXPECT_EQ(info.floor_textures[1].covariance, texture_.covariance);
  EXPECT_TRUE(HasLayer(info.layers, kFloorTextureLayer));
}

TEST_F(FloorTextureTableTest, WithoutAModelThereIsNoLayer) {
  const std::filesystem::path plain = folder_.path() / "plain.floormap";
  EXPECT_NE(WriteMap(plain, MakeContent()), version_);
  const MapInfo info = MapDatabase(plain).ReadInfo();
  EXPECT_FALSE(HasLayer(info.layers, kFloorTextureLayer));
  EXPECT_TRUE(info.floor_textures.empty());
}

TEST_F(FloorTextureTableTest, AMapOfAnOlderProgramHasNoTable) {
  RunSql(file_, "DELETE FROM layer WHERE name = 'floor_texture'; DROP TABLE floor_texture");
  EXPECT_TRUE(MapDatabase(file_).ReadMap().info.floor_textures.empty());
}

TEST_F(FloorTextureTableTest, ADamagedModelIsRefused) {
  const std::string bytes = testing_map::ReadBytes(file_);
  for (const std::string damage :
       {"UPDATE floor_texture SET survey = 2", "UPDATE floor_texture SET blocks = 0",
        "UPDATE floor_texture SET blocks = 'many'", "UPDATE floor_texture SET mean = x''",
        "UPDATE floor_texture SET mean = zeroblob(48)", "UPDATE floor_texture SET mean = substr(covariance, 1, 39)",
        "UPDATE floor_texture SET mean = x'000000000000F07F' || substr(mean, 9)",
        "UPDATE floor_texture SET mean = CAST(x'0000000000408F40' || substr(mean, 9) AS BLOB)",
        "UPDATE floor_texture SET covariance = zeroblob(120)", "UPDATE floor_texture SET covariance = zeroblob(112)",
        "DROP TABLE floor_texture"}) {
    testing_map::WriteBytes(file_, bytes);
    RunSql(file_, damage);
    EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).ReadMap(); }), HasSubstr("m.floormap")) << damage;
  }
}

TEST_F(FloorTextureTableTest, VerifyFindsAnotherModel) {
  RunSql(file_, "UPDATE floor_texture SET blocks = 121");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("its layer 'floor_texture'"));
}

}  // namespace
}  // namespace floorloc
