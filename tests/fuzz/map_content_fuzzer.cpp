// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "tests/fuzz/map_commands.h"
#include "tests/fuzz/map_damage.h"
#include "tests/fuzz/small_map.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr int kMaxChanges = 4;

/// A whole map, and the folders in which its damaged copy is read.
struct Workshop {
  Workshop() {
    std::filesystem::create_directory(folder.path() / "maps");
    std::filesystem::create_directory(files.out);
    WriteSmallSurvey(folder.path() / "survey", 0.4, 6);
    WriteSmallSurvey(files.survey, 0.52, 5);
    WriteSmallMap(folder.path() / "survey", files.whole_map);
    std::filesystem::copy_file(files.whole_map, bare);
    MapDamage::AddLattice(bare);
    MapDamage::DropConstraints(bare);
  }

  TemporaryFolder folder;
  MapCommandFiles files{folder.path() / "whole.floormap", folder.path() / "new_survey", folder.path() / "out"};
  std::filesystem::path bare = folder.path() / "bare.floormap";
  std::filesystem::path damaged = folder.path() / "maps" / "damaged.floormap";
};

// Up to four changes of rows.
void ChangeRows(const std::filesystem::path& map, bool renew_checksums, ByteSource& source) {
  MapDamage damage(map);
  for (int i = 0; i < kMaxChanges && !source.empty(); ++i) {
    const std::string sql = damage.Change(source);
    if (std::getenv("FLOORLOC_FUZZ_TELL") != nullptr) {
      std::cerr << sql << "\n";
    }
  }
  if (renew_checksums) {
    damage.RenewChecksums();
  }
}

// Sets bytes: three of the place, one of the value.
void ChangeBytes(const std::filesystem::path& map, ByteSource& source) {
  const std::size_t size = std::filesystem::file_size(map);
  std::fstream file(map, std::ios::binary | std::ios::in | std::ios::out);
  while (!source.empty()) {
    const std::size_t low = source.Short();
    file.seekp(static_cast<std::streamoff>((low | static_cast<std::size_t>(source.Byte()) << 16) % size));
    file.put(static_cast<char>(source.Byte()));
  }
}

}  // namespace
}  // namespace floorloc

// Which command reads the map (a byte), how it is damaged (a byte: 0 in its rows, and the checksums are made right
// again, 1 without that, 2 in its bytes), then the changes. FLOORLOC_FUZZ_TELL in the environment prints those of rows.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const Workshop workshop;
  ByteSource source({data, size});
  const std::size_t command = source.Below(CountMapCommands());
  const std::size_t kind = source.Below(3);
  std::filesystem::copy_file(workshop.bare, workshop.damaged, std::filesystem::copy_options::overwrite_existing);
  if (kind == 2) {
    ChangeBytes(workshop.damaged, source);
  } else {
    ChangeRows(workshop.damaged, kind == 0, source);
  }
  RunMapCommand(command, workshop.damaged, workshop.files);
  return 0;
}
