// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "core/io/input_error.h"
#include "mapbuilder/bag/rosbag1_reader.h"
#include "tests/fuzz/refusal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  MayRefuse<InputError>([&] {
    const std::unique_ptr<BagReader> reader = ReadRosbag1(MemorySource({data, size}, "fuzzed"));
    while (reader->Next()) {
    }
  });
  return 0;
}
