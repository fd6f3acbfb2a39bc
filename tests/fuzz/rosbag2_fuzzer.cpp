// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <fstream>

#include "core/io/input_error.h"
#include "mapbuilder/bag/rosbag2_reader.h"
#include "tests/fuzz/refusal.h"
#include "tests/synthetic/temporary_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.db3";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  MayRefuse<InputError>([&] {
    const std::unique_ptr<BagReader> reader = ReadRosbag2(file);
    while (reader->Next()) {
    }
  });
  return 0;
}
