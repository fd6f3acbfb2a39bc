// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/map/map_database.h"

// Reads the bytes as a map file that lives in memory.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("fuzzed", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) {
    return 0;
  }
  try {
    const floorloc::MapDatabase map("/proc/self/fd/" + std::to_string(file));
    map.ReadFrames();
    map.ReadMap();
    map.VerifyContent();
  } catch (const floorloc::MapError&) {
    // The only way to refuse a map.
  }
  close(file);
  return 0;
}
