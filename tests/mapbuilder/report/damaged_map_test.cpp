// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "core/io/input_error.h"
#include "core/localization/localizer.h"
#include "mapbuilder/export/export_geotiff.h"
#include "mapbuilder/export/export_mosaic.h"
#include "mapbuilder/export/export_nav2.h"
#include "mapbuilder/export/export_pose_graph.h"
#include "mapbuilder/export/export_tiles.h"
#include "mapbuilder/finished_map/map_diff.h"
#include "mapbuilder/merge/merge_maps.h"
#include "mapbuilder/report/write_report.h"
#include "tests/core/map/map_damages.h"
#include "tests/mapbuilder/report/small_map.h"

namespace floorloc {
namespace {

using testing_map::FatalDamages;
using testing_map::OtherDamages;

// Runs the commands that read maps on a damaged file.
class DamagedMapTest : public ::testing::Test {
 protected:
  DamagedMapTest() {
    merge_.alignment.same_frame = true;
    merge_.out = folder_.path() / "merged.floormap";
    extend_.surveys = {SmallMap::Get().survey()};
    extend_.out = folder_.path() / "extended.floormap";
    extend_.extend = damaged_;
    extend_.mosaic.resolution_m = 0.0056;
  }

  void Damage(const std::string& sql) const {
    std::filesystem::copy_file(whole_, damaged_, std::filesystem::copy_options::overwrite_existing);
    testing_map::RunSql(damaged_, sql);
  }

  // Commands that read the whole map.
  std::map<std::string, std::function<void()>> WholeMapCommands() {
    return {
        {"info", [this] { MapDatabase(damaged_).ReadMap(); }},
        {"verify", [this] { MapDatabase(damaged_).VerifyContent(); }},
        {"localize", [this] { const Localizer localizer(MapDatabase(damaged_).ReadMap(), LocalizerOptions()); }},
        {"diff to", [this] { CompareMaps(MapDatabase(whole_), MapDatabase(damaged_)); }},
        {"diff from", [this] { CompareMaps(MapDatabase(damaged_), MapDatabase(whole_)); }},
        {"merge into", [this] { Merge(damaged_, whole_); }},
        {"merge", [this] { Merge(whole_, damaged_); }},
        {"extend", [this] { BuildMap(extend_); }},
        {"report", [this] { WriteReport(damaged_, folder_.path() / "report"); }},
    };
  }

  // Commands that read parts of it.
  std::map<std::string, std::function<void()>> ExportCommands() {
    return {
        {"mosaic", [this] { ExportMosaic(MapDatabase(damaged_), 0.0); }},
        {"coarse mosaic", [this] { ExportMosaic(MapDatabase(damaged_), 0.05); }},
        {"geotiff", [this] { ExportGeoTiff(MapDatabase(damaged_), 0.0, folder_.path() / "m.tif"); }},
        {"tiles", [this] { ExportTiles(MapDatabase(damaged_), folder_.path() / "tiles"); }},
        {"nav2", [this] { MakeOccupancyGrid(MapDatabase(damaged_), 0.05); }},
        {"poses", [this] { MapDatabase(damaged_).ReadFrames(); }},
        {"camera", [this] { MapDatabase(damaged_).ReadInfo(); }},
        {"g2o",
         [this] {
           const MapDatabase map(damaged_);
           FormatG2o(map.ReadFrames(), map.ReadLinks());
         }},
    };
  }

  void Merge(const std::filesystem::path& first, const std::filesystem::path& second) {
    merge_.first = first;
    merge_.second = second;
    MergeMaps(merge_);
  }

  // Message of the command's MapError or InputError, or "". Other exceptions are not meant for users and fail the test.
  static std::string SentenceOf(const std::function<void()>& command) {
    try {
      command();
    } catch (const MapError& error) {
      return error.what();
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  TemporaryFolder folder_;
  std::filesystem::path whole_ = SmallMap::Get().file();
  std::filesystem::path damaged_ = folder_.path() / "damaged.floormap";
  MergeOptions merge_;
  BuildOptions extend_;
};

TEST_F(DamagedMapTest, TheWholeMapPassesEveryCommand) {
  Damage("SELECT 1");
  for (const auto& commands : {WholeMapCommands(), ExportCommands()}) {
    for (const auto& [name, command] : commands) {
      EXPECT_EQ(SentenceOf(command), "") << name;
      std::filesystem::remove_all(folder_.path() / "tiles");
    }
  }
}

TEST_F(DamagedMapTest, EveryCommandRefusesWhatNoneCanUse) {
  for (const std::string& damage : FatalDamages()) {
    Damage(damage);
    for (const auto& [name, command] : WholeMapCommands()) {
      const std::string sentence = SentenceOf(command);
      EXPECT_THAT(sentence, ::testing::HasSubstr("damaged.floormap")) << name << " after " << damage;
      EXPECT_THAT(sentence, ::testing::HasSubstr("restore it from a copy or build it again"))
          << name << " after " << damage;
      EXPECT_EQ(sentence.find('\n'), std::string::npos) << name << " after " << damage;
    }
  }
}

// An export may succeed when it does not read the damaged content.
TEST_F(DamagedMapTest, ExportsRefuseOrWork) {
  for (const auto& damages : {FatalDamages(), OtherDamages()}) {
    for (const std::string& damage : damages) {
      Damage(damage);
      for (const auto& [name, command] : ExportCommands()) {
        EXPECT_EQ(SentenceOf(command).find('\n'), std::string::npos) << name << " after " << damage;
        std::filesystem::remove_all(folder_.path() / "tiles");
      }
    }
  }
}

// A whole build takes long; it reads the map as a merge does.
TEST_F(DamagedMapTest, OtherDamageIsRefusedOrHarmless) {
  auto commands = WholeMapCommands();
  commands.erase("extend");
  for (const std::string& damage : OtherDamages()) {
    Damage(damage);
    for (const auto& [name, command] : commands) {
      EXPECT_EQ(SentenceOf(command).find('\n'), std::string::npos) << name << " after " << damage;
    }
  }
}

}  // namespace
}  // namespace floorloc
