// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "core/map/map_database.h"
#include "tests/fuzz/refusal.h"
#include "tests/synthetic/temporary_folder.h"

// The bytes as a map file. SQLite opens no file that has no name, so it cannot stay in memory.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "fuzzed.floormap";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  MayRefuse<MapError>([&] {
    const MapDatabase map(file);
    map.ReadFrames();
    map.ReadLinks();
    map.ReadMap();
    map.VerifyContent();
  });
  return 0;
}
