// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace floorloc {

/// SHA-256 of a sequence of blobs, numbers and texts.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  ContentHash& Add(std::span<const std::uint8_t> bytes);
  ContentHash& Add(std::int64_t number);
  ContentHash& Add(double number);
  ContentHash& Add(const std::string& text);  ///< with its length, so that "ab","c" differs from "a","bc"

  /// 64 hex digits. Nothing can be added afterwards.
  std::string Hex();
  /// The first eight bytes, big-endian.
  std::int64_t Checksum();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floorloc
