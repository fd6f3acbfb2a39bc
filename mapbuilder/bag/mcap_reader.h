// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "mapbuilder/bag/bag_reader.h"
#include "mapbuilder/bag/byte_source.h"

namespace floorloc {

/// Reads MCAP (mcap.dev/spec), chunked or not, by its data section alone: indexes and summaries are not needed, and may
/// be missing. Checksums of chunks are verified where they are given. Throws InputError.
std::unique_ptr<BagReader> ReadMcap(std::unique_ptr<ByteSource> source);

}  // namespace floorloc
