// SPDX-License-Identifier: Apache-2.0
#include "core/map/floor_lattice_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/map/map_layers.h"
#include "tests/core/map/map_damages.h"
#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing_map::ErrorOf;
using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::RunSql;

// A map of two rooms with different tiles.
class FloorLatticeTableTest : public ::testing::Test {
 protected:
  FloorLatticeTableTest() {
    MapLattice room;
    room.extent = {-1.5, 0.25, -0.7, 1.3};
    room.floor_share = 2.0 / 3.0;
    room.basis << 0.3, 0.001, -0.001, 0.2;
    room.point_m = {-0.5, 1.0 / 3.0};
    room.residual_m = 3e-4;
    room.share = 0.92;
    content_.info.lattices = {room, room};
    content_.info.lattices[1].basis *= 0.7;
    version_ = WriteMap(file_, content_);
  }

  MapContent content_ = MakeContent();
  testing_map::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "m.floormap";
  std::string version_;
};

TEST_F(FloorLatticeTableTest, WhatIsWrittenIsRead) {
  const MapDatabase database(file_);
  database.VerifyContent();
  const MapInfo info = database.ReadInfo();
  EXPECT_TRUE(HasLayer(info.layers, kFloorLatticeLayer));
  ASSERT_EQ(info.lattices.size(), 2U);
  for (std::size_t i = 0; i < info.lattices.size(); ++i) {
    const MapLattice& written = content_.info.lattices[i];
    const MapLattice& read = info.lattices[i];
    EXPECT_EQ(read.extent.x_min, written.extent.x_min);
    EXPECT_EQ(read.extent.x_max, written.extent.x_max);
    EXPECT_EQ(read.extent.y_min, written.extent.y_min);
    EXPECT_EQ(read.extent.y_max, written.extent.y_max);
    EXPECT_EQ(read.floor_share, written.floor_share);
    EXPECT_EQ(read.basis, written.basis);
    EXPECT_EQ(read.point_m, written.point_m);
    EXPECT_EQ(read.residual_m, written.residual_m);
    EXPECT_EQ(read.share, written.share);
  }
}

TEST_F(FloorLatticeTableTest, WhereTheFloorDoesNotRepeatThereIsNoLayer) {
  const std::filesystem::path plain = folder_.path() / "plain.floormap";
  EXPECT_NE(WriteMap(plain, MakeContent()), version_);
  const MapInfo info = MapDatabase(plain).ReadInfo();
  EXPECT_FALSE(HasLayer(info.layers, kFloorLatticeLayer));
  EXPECT_TRUE(info.lattices.empty());
}

TEST_F(FloorLatticeTableTest, AMapOfAnOlderProgramHasNoTable) {
  RunSql(file_, "DELETE FROM layer WHERE name = 'floor_lattice'; DROP TABLE floor_lattice");
  EXPECT_TRUE(MapDatabase(file_).ReadMap().info.lattices.empty());
}

TEST_F(FloorLatticeTableTest, ADamagedRowIsRefusedWithItsName) {
  const std::string bytes = testing_map::ReadBytes(file_);
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"region = region + 1", "numbered"},
      {"x_min = 0.3", "x_min exceeds x_max"},
      {"y_max = -9e999", "y_max"},
      {"floor_share = 1.1", "floor_share"},
      {"first_x = 9e999", "first_x"},
      {"first_x = 'wide'", "first_x"},
      {"first_x = 0, first_y = 0.009", "shorter than a centimetre"},
      {"second_x = 101", "second_x"},
      {"second_x = 0.6, second_y = 0", "almost parallel"},
      {"point_x = 1e300", "point_x"},
      {"residual_m = -1", "residual_m"},
      {"share = 1.5", "share"},
  };
  for (const auto& [damage, what] : damages) {
    testing_map::WriteBytes(file_, bytes);
    RunSql(file_, "UPDATE floor_lattice SET " + damage + " WHERE region = 1");
    EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).ReadMap(); }),
                AllOf(HasSubstr("m.floormap is damaged (floor_lattice 1: "), HasSubstr(what)))
        << damage;
  }
  RunSql(file_, "DROP TABLE floor_lattice");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).ReadMap(); }), HasSubstr("m.floormap"));
}

TEST_F(FloorLatticeTableTest, VerifyFindsAnotherLattice) {
  RunSql(file_, "UPDATE floor_lattice SET share = 0.5 WHERE region = 0");
  EXPECT_THAT(ErrorOf([this] { MapDatabase(file_).VerifyContent(); }), HasSubstr("its layer 'floor_lattice'"));
}

}  // namespace
}  // namespace floorloc
