// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace floorloc {

/// Bytes that are read once, from the first to the last: a file, or what is compressed in it.
class ByteSource {
 public:
  ByteSource() = default;
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Fills `out` and returns how many bytes there were: fewer at the end only. Throws InputError.
  std::size_t Read(std::span<std::uint8_t> out);
  /// Replaces the content of `out` by the next `size` bytes, or by what is left of them; true when all were there.
  /// Memory grows with what is read, not with `size`.
  bool Read(std::uint64_t size, std::vector<std::uint8_t>* out);
  /// Leaves bytes out; false when there were fewer.
  bool Skip(std::uint64_t size);

  std::uint64_t position() const { return position_; }  ///< bytes that were read or left out
  const std::filesystem::path& file() const { return file_; }

 protected:
  explicit ByteSource(std::filesystem::path file) : file_(std::move(file)) {}

  virtual std::size_t DoRead(std::span<std::uint8_t> out) = 0;
  virtual std::uint64_t DoSkip(std::uint64_t size);

 private:
  std::filesystem::path file_;
  std::uint64_t position_ = 0;
};

/// Opens a file; what is inside, where it is a zstd frame. Throws InputError.
std::unique_ptr<ByteSource> OpenByteSource(const std::filesystem::path& file);

/// Reads from memory that outlives the source. `file` names it in errors.
std::unique_ptr<ByteSource> MemorySource(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

}  // namespace floorloc
