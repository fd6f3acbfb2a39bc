// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/decompress.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>

namespace floorloc {
namespace {

constexpr std::size_t kStepBytes = 1u << 20;

// One call of a decoder: how many bytes it took and gave, and whether it can go on.
struct Step {
  std::size_t taken = 0;
  std::size_t given = 0;
  std::string damage = {};
};
using Decoder = std::function<Step(std::span<const std::uint8_t> from, std::span<std::uint8_t> to)>;

Decompressed Run(const Decoder& decode, std::span<const std::uint8_t> bytes, std::uint64_t size,
                 std::vector<std::uint8_t>* out) {
  out->clear();
  while (out->size() < size) {
    const std::size_t before = out->size();
    out->resize(before + static_cast<std::size_t>(std::min<std::uint64_t>(size - before, kStepBytes)));
    const Step step = decode(bytes, std::span(*out).subspan(before));
    out->resize(before + step.given);
    bytes = bytes.subspan(step.taken);
    if (!step.damage.empty()) {
      return {false, step.damage};
    }
    if (step.given == 0 && step.taken == 0) {
      return {};
    }
  }
  return {true, {}};
}

Decompressed RunLz4(std::span<const std::uint8_t> bytes, std::uint64_t size, std::vector<std::uint8_t>* out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                   &LZ4F_freeDecompressionContext);
  const Decoder decode = [&](std::span<const std::uint8_t> from, std::span<std::uint8_t> to) {
    std::size_t taken = from.size();
    std::size_t given = to.size();
    const std::size_t code = LZ4F_decompress(context, to.data(), &given, from.data(), &taken, nullptr);
    return LZ4F_isError(code) ? Step{0, 0, LZ4F_getErrorName(code)} : Step{taken, given};
  };
  return Run(decode, bytes, size, out);
}

Decompressed RunZstd(std::span<const std::uint8_t> bytes, std::uint64_t size, std::vector<std::uint8_t>* out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  const Decoder decode = [&](std::span<const std::uint8_t> from, std::span<std::uint8_t> to) {
    ZSTD_inBuffer input{from.data(), from.size(), 0};
    ZSTD_outBuffer output{to.data(), to.size(), 0};
    const std::size_t code = ZSTD_decompressStream(context.get(), &output, &input);
    return ZSTD_isError(code) ? Step{0, 0, ZSTD_getErrorName(code)} : Step{input.pos, output.pos};
  };
  return Run(decode, bytes, size, out);
}

Decompressed RunBzip2(std::span<const std::uint8_t> bytes, std::uint64_t size, std::vector<std::uint8_t>* out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream, &BZ2_bzDecompressEnd);
  const Decoder decode = [&](std::span<const std::uint8_t> from, std::span<std::uint8_t> to) {
    const std::size_t available = std::min<std::size_t>(from.size(), std::numeric_limits<unsigned>::max());
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(from.data()));  // only read
    stream.avail_in = static_cast<unsigned>(available);
    stream.next_out = reinterpret_cast<char*>(to.data());
    stream.avail_out = static_cast<unsigned>(to.size());
    const int code = BZ2_bzDecompress(&stream);
    Step step{available - stream.avail_in, to.size() - stream.avail_out};
    if (code == BZ_OK || code == BZ_STREAM_END) {
      return step;
    }
    return Step{step.taken, step.given, "bzip2 error " + std::to_string(code)};
  };
  return Run(decode, bytes, size, out);
}

}  // namespace

Compression ParseCompression(std::string_view name) {
  if (name.empty() || name == "none") {
    return Compression::kNone;
  }
  return name == "lz4"    ? Compression::kLz4
         : name == "zstd" ? Compression::kZstd
         : name == "bz2"  ? Compression::kBzip2
                          : Compression::kUnknown;
}

Decompressed Decompress(Compression compression, std::span<const std::uint8_t> bytes, std::uint64_t size,
                        std::vector<std::uint8_t>* out) {
  switch (compression) {
    case Compression::kNone:
      out->assign(bytes.begin(),
                  bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(size, bytes.size())));
      return {out->size() == size, {}};
    case Compression::kLz4:
      return RunLz4(bytes, size, out);
    case Compression::kZstd:
      return RunZstd(bytes, size, out);
    case Compression::kBzip2:
      return RunBzip2(bytes, size, out);
    case Compression::kUnknown:
      break;
  }
  out->clear();
  return {false, "its compression is not known"};
}

}  // namespace floorloc
