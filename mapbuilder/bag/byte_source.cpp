// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/byte_source.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr std::size_t kStepBytes = 4u << 20;
constexpr std::array<std::uint8_t, 4> kZstdMagic = {0x28, 0xB5, 0x2F, 0xFD};

class FileSource : public ByteSource {
 public:
  explicit FileSource(const std::filesystem::path& path) : ByteSource(path), stream_(path, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    if (!stream_ || error) {
      throw InputError(path, "cannot be read; check the path and its permissions");
    }
  }

  bool StartsWith(std::span<const std::uint8_t> magic) {
    std::vector<std::uint8_t> start(magic.size());
    const bool whole = DoRead(start) == magic.size();
    stream_.clear();
    stream_.seekg(0);
    at_ = 0;
    return whole && std::equal(start.begin(), start.end(), magic.begin());
  }

  std::size_t DoRead(std::span<std::uint8_t> out) override {
    stream_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    if (stream_.bad()) {
      throw InputError(file(), "cannot be read to its end; check the disk");
    }
    at_ += static_cast<std::uint64_t>(stream_.gcount());
    return static_cast<std::size_t>(stream_.gcount());
  }

  std::uint64_t DoSkip(std::uint64_t size) override {
    const std::uint64_t skipped = std::min(size, size_ - std::min(at_, size_));
    stream_.seekg(static_cast<std::streamoff>(skipped), std::ios::cur);
    at_ += skipped;
    return skipped;
  }

 private:
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;
};

class SpanSource : public ByteSource {
 public:
  SpanSource(std::span<const std::uint8_t> bytes, const std::filesystem::path& file)
      : ByteSource(file), bytes_(bytes) {}

  std::size_t DoRead(std::span<std::uint8_t> out) override {
    const std::size_t count = std::min(out.size(), bytes_.size());
    std::copy_n(bytes_.begin(), count, out.begin());
    bytes_ = bytes_.subspan(count);
    return count;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

// A file that was compressed as a whole, as `ros2 bag record --compression-mode file` does it.
class ZstdSource : public ByteSource {
 public:
  explicit ZstdSource(std::unique_ptr<ByteSource> inner)
      : ByteSource(inner->file()),
        inner_(std::move(inner)),
        context_(ZSTD_createDCtx()),
        input_(ZSTD_DStreamInSize()) {}

  std::size_t DoRead(std::span<std::uint8_t> out) override {
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    while (to.pos < to.size) {
      if (from_.pos == from_.size) {
        from_ = {input_.data(), inner_->Read(std::span(input_)), 0};
      }
      const bool at_end = from_.size == 0;
      const std::size_t before = to.pos;
      const std::size_t code = ZSTD_decompressStream(context_.get(), &to, &from_);
      if (ZSTD_isError(code)) {
        throw InputError(
            file(), std::string("its zstd frame is damaged (") + ZSTD_getErrorName(code) + "); copy the file again");
      }
      if (at_end && to.pos == before) {
        break;
      }
    }
    return to.pos;
  }

 private:
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ByteSource> inner_;
  std::unique_ptr<ZSTD_DCtx, Free> context_;
  std::vector<std::uint8_t> input_;
  ZSTD_inBuffer from_{nullptr, 0, 0};
};

}  // namespace

std::size_t ByteSource::Read(std::span<std::uint8_t> out) {
  const std::size_t count = DoRead(out);
  position_ += count;
  return count;
}

bool ByteSource::Read(std::uint64_t size, std::vector<std::uint8_t>* out) {
  out->clear();
  while (out->size() < size) {
    const std::size_t before = out->size();
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(size - before, kStepBytes));
    out->resize(before + step);
    const std::size_t count = Read(std::span(*out).subspan(before));
    out->resize(before + count);
    if (count < step) {
      return false;
    }
  }
  return true;
}

bool ByteSource::Skip(std::uint64_t size) {
  const std::uint64_t skipped = DoSkip(size);
  position_ += skipped;
  return skipped == size;
}

std::uint64_t ByteSource::DoSkip(std::uint64_t size) {
  std::array<std::uint8_t, 65536> ignored;
  std::uint64_t skipped = 0;
  while (skipped < size) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(size - skipped, ignored.size()));
    const std::size_t count = DoRead(std::span(ignored).first(step));
    skipped += count;
    if (count < step) {
      break;
    }
  }
  return skipped;
}

std::unique_ptr<ByteSource> OpenByteSource(const std::filesystem::path& file) {
  auto source = std::make_unique<FileSource>(file);
  if (source->StartsWith(kZstdMagic)) {
    return std::make_unique<ZstdSource>(std::move(source));
  }
  return source;
}

std::unique_ptr<ByteSource> MemorySource(std::span<const std::uint8_t> bytes, const std::filesystem::path& file) {
  return std::make_unique<SpanSource>(bytes, file);
}

}  // namespace floorloc
