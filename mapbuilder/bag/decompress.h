// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace floorloc {

/// Of a chunk or a message: what both kinds of bags call "", "none", "lz4" (its frame format), "zstd" and "bz2".
enum class Compression { kNone, kLz4, kZstd, kBzip2, kUnknown };

Compression ParseCompression(std::string_view name);

struct Decompressed {
  bool whole = false;  ///< `out` has the size that was told
  std::string damage;  ///< why not, when the bytes are wrong; empty: they end too early
};

/// Replaces the content of `out` by what is compressed in `bytes`, at most `size` bytes; by its beginning when `bytes`
/// are cut off or damaged. Memory grows with what is decompressed, not with `size`.
Decompressed Decompress(Compression compression, std::span<const std::uint8_t> bytes, std::uint64_t size,
                        std::vector<std::uint8_t>* out);

}  // namespace floorloc
