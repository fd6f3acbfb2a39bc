// SPDX-License-Identifier: Apache-2.0
#include "server/store/state_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/io/input_error.h"
#include "server/store/success_table.h"
#include "server/store/vehicle_table.h"
#include "server/store/version_table.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using Mode = StateFile::Mode;
constexpr auto kProcess = StateFile::Durability::kProcess;

class StateFileTest : public testing::Test {
 protected:
  std::string ErrorOfOpening() {
    try {
      StateFile state(file_, Mode::kWrite);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "state.sqlite";
};

TEST_F(StateFileTest, RemembersWhereImagesWereFoundInOneVersionOfAMap) {
  StateFile state(file_, Mode::kWrite);
  state.Write(kProcess, [&](const SqliteConnection& connection) {
    WriteSuccess(connection, "hall", {"v1", 0.5, 10.0, 3, {}});
    WriteSuccessSquare(connection, "hall", {-2, 7, 5, 1, 600});
    WriteSuccess(connection, "hall", {"v1", 0.5, 10.0, 4, {}});
    WriteSuccessSquare(connection, "hall", {-2, 7, 6, 1, 700});
    WriteSuccessSquare(connection, "hall", {1, 7, -6, 1, 700});  // as no server writes it
  });
  state.Read([&](const SqliteConnection& connection) {
    const MapSuccess hall = ReadSuccess(connection).at("hall");
    EXPECT_EQ(hall.version, "v1");
    EXPECT_EQ(hall.since_s, 10.0);
    EXPECT_EQ(hall.unplaced, 4);
    ASSERT_EQ(hall.squares.size(), 1U);
    EXPECT_EQ(hall.squares[0].x, -2);
    EXPECT_EQ(hall.squares[0].y, 7);
    EXPECT_EQ(hall.squares[0].found, 6);
    EXPECT_EQ(hall.squares[0].inliers, 700);
  });
  state.Write(kProcess, [&](const SqliteConnection& connection) {
    WriteSuccess(connection, "hall", {"v2", 0.5, 20.0, 0, {}});
  });
  state.Read(
      [&](const SqliteConnection& connection) { EXPECT_TRUE(ReadSuccess(connection).at("hall").squares.empty()); });
  state.Write(kProcess, [&](const SqliteConnection& connection) { DeleteSuccess(connection, "hall"); });
  state.Read([&](const SqliteConnection& connection) { EXPECT_TRUE(ReadSuccess(connection).empty()); });
}

TEST_F(StateFileTest, RemembersVersionsAndVehicles) {
  const MapVersion version{"v1", "id", "2026", "0.1", {"a", "b"}, 3.5, 1000, 12.5, "upload"};
  RememberedTrack track;
  track.pose = {"id", 42, Pose2(1.0, 2.0, 0.5), Eigen::Vector3d(1e-6, 2e-6, 3e-6).asDiagonal()};
  track.epoch = 7;
  track.last_heard_s = 99.5;
  {
    StateFile state(file_, Mode::kWrite);
    state.Write(kProcess, [&](const SqliteConnection& connection) {
      WriteVersion(connection, "hall", version);
      WriteActive(connection, "hall", {"v1", "v0", "1:2:3", "v1", {}});
      WriteRegistration(connection, "agv", "{}");
      WriteRegistration(connection, "new", "{}");
      WriteTrack(connection, "agv", track);
      WriteTrack(connection, "nobody", track);
    });
  }
  const StateFile state(file_, Mode::kRead);
  state.Read([&](const SqliteConnection& connection) {
    const MapVersions hall = ReadVersions(connection).at("hall");
    EXPECT_EQ(hall.active, "v1");
    EXPECT_EQ(hall.previous, "v0");
    ASSERT_NE(hall.Find("v1"), nullptr);
    EXPECT_EQ(hall.Find("v1")->parents, version.parents);
    EXPECT_EQ(hall.Find("v1")->bytes, 1000);
    const std::vector<RememberedVehicle> vehicles = ReadVehicles(connection);
    ASSERT_EQ(vehicles.size(), 2U);
    ASSERT_TRUE(vehicles[0].track && vehicles[0].track->pose);
    EXPECT_EQ(vehicles[0].track->pose->stamp_ns, 42);
    EXPECT_EQ(vehicles[0].track->pose->map_from_base.y(), 2.0);
    EXPECT_EQ(vehicles[0].track->pose->covariance, track.pose->covariance);
    EXPECT_EQ(vehicles[0].track->epoch, 7U);
    EXPECT_FALSE(vehicles[1].track);
  });
}

TEST_F(StateFileTest, APoseThatNoServerWroteIsNone) {
  StateFile state(file_, Mode::kWrite);
  for (const char* damage : {"UPDATE pose SET x = 9e999", "UPDATE pose SET covariance = zeroblob(72)",
                             "UPDATE pose SET covariance = x'00'", "UPDATE pose SET y = 1e9"}) {
    RememberedTrack track;
    track.pose = RememberedPose{"id", 1, Pose2(), Eigen::Matrix3d::Identity()};
    state.Write(kProcess, [&](const SqliteConnection& connection) {
      WriteRegistration(connection, "agv", "{}");
      WriteTrack(connection, "agv", track);
      connection.Execute(damage);
      EXPECT_FALSE(ReadVehicles(connection)[0].track->pose) << damage;
    });
  }
}

TEST_F(StateFileTest, RemembersWhatVehiclesHaveLearnt) {
  StateFile state(file_, Mode::kWrite);
  state.Write(kProcess, [&](const SqliteConnection& connection) {
    WriteRegistration(connection, "agv", "{}");
    WriteRegistration(connection, "new", "{}");
    WriteLearning(connection, "agv", {1, 2, {0.0}});
    WriteLearning(connection, "agv", {-7, 8, {1.0, 2.5}});
    WriteLearning(connection, "nobody", {1, 2, {3.0}});
    const std::vector<RememberedVehicle> vehicles = ReadVehicles(connection);
    ASSERT_EQ(vehicles.size(), 2U);
    ASSERT_TRUE(vehicles[0].learning);
    EXPECT_EQ(vehicles[0].learning->camera, -7);
    EXPECT_EQ(vehicles[0].learning->camera_in_map, 8);
    EXPECT_EQ(vehicles[0].learning->values, (std::vector<double>{1.0, 2.5}));
    EXPECT_FALSE(vehicles[1].learning);
    DeleteVehicle(connection, "agv");
    WriteRegistration(connection, "agv", "{}");
    EXPECT_FALSE(ReadVehicles(connection)[0].learning);
  });
}

TEST_F(StateFileTest, DamagedLearningIsNone) {
  StateFile state(file_, Mode::kWrite);
  for (const char* damage :
       {"UPDATE learnt SET learnt_values = x'0000000000000000'", "UPDATE learnt SET learnt_values = 'text'",
        "UPDATE learnt SET learnt_values = zeroblob(5000000)", "UPDATE learnt SET checksum = 'x'"}) {
    state.Write(kProcess, [&](const SqliteConnection& connection) {
      WriteRegistration(connection, "agv", "{}");
      WriteLearning(connection, "agv", {1, 2, {1.0}});
      EXPECT_EQ(ReadVehicles(connection)[0].learning->values.size(), 1U);
      connection.Execute(damage);
      ASSERT_TRUE(ReadVehicles(connection)[0].learning) << damage;
      EXPECT_TRUE(ReadVehicles(connection)[0].learning->values.empty()) << damage;
    });
  }
}

TEST_F(StateFileTest, AFileWithoutLearningGetsItsTable) {
  StateFile(file_, Mode::kWrite).Write(kProcess, [](const SqliteConnection& connection) {
    connection.Execute("DROP TABLE learnt");
    WriteRegistration(connection, "agv", "{}");
  });
  StateFile state(file_, Mode::kWrite);
  state.Write(kProcess, [](const SqliteConnection& connection) {
    ASSERT_EQ(ReadVehicles(connection).size(), 1U);
    WriteLearning(connection, "agv", {1, 2, {1.0}});
    EXPECT_TRUE(ReadVehicles(connection)[0].learning);
  });
}

TEST_F(StateFileTest, AChangeThatFailsLeavesNothing) {
  StateFile state(file_, Mode::kWrite);
  EXPECT_THROW(state.Write(kProcess,
                           [](const SqliteConnection& connection) {
                             WriteRegistration(connection, "agv", "{}");
                             throw std::runtime_error("no");
                           }),
               std::runtime_error);
  state.Read([](const SqliteConnection& connection) { EXPECT_TRUE(ReadVehicles(connection).empty()); });
}

TEST_F(StateFileTest, IsWrittenByOneServer) {
  const StateFile state(file_, Mode::kWrite);
  EXPECT_THROW(StateFile(file_, Mode::kWrite), StateInUse);
  EXPECT_NO_THROW(StateFile(file_, Mode::kRead));
}

TEST_F(StateFileTest, WhatIsNoStateIsRefused) {
  std::ofstream(file_)
      << "this is a text, and longer than a header of SQLite would be, which is a hundred bytes, or so";
  EXPECT_THAT(ErrorOfOpening(), testing::HasSubstr("move it away"));
  std::filesystem::remove(file_);
  {
    StateFile(file_, Mode::kWrite).Write(kProcess, [](const SqliteConnection& c) {
      c.Execute("PRAGMA user_version = 2");
    });
  }
  EXPECT_THAT(ErrorOfOpening(), testing::HasSubstr("another version"));
  { SqliteConnection(folder_.path() / "other.sqlite", SqliteConnection::Mode::kCreate).Execute("CREATE TABLE t (a)"); }
  file_ = folder_.path() / "other.sqlite";
  EXPECT_THAT(ErrorOfOpening(), testing::HasSubstr("not a state"));
}

}  // namespace
}  // namespace floorloc
