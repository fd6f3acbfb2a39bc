// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>

#include "mapbuilder/batch/build_journal.h"
#include "tests/synthetic/temporary_folder.h"

// The bytes as the file that a killed build left: whatever it holds, new pieces can be added and are there afterwards.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const floorloc::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "m.floormap.journal";
  const std::string old_key(64, 'a');
  const std::string new_key(64, 'b');
  const std::vector<std::uint8_t> piece = {1, 2, 3};
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  {
    floorloc::BuildJournal journal(file, true, nullptr);
    journal.Get(old_key);
    journal.Put(new_key, piece);
    journal.Flush();
  }
  floorloc::BuildJournal journal(file, true, nullptr);
  if (journal.Get(new_key) != piece) {
    std::abort();
  }
  journal.Remove();
  return 0;
}
