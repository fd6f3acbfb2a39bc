// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "mapbuilder/bag/bag_reader.h"

namespace floorloc {

/// The bags that tests/mapbuilder/bag/generate made.
inline std::filesystem::path BagData(const std::string& name) {
  return std::filesystem::path(FLOORLOC_BAG_DATA) / name;
}

inline std::vector<std::uint8_t> BytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A message that outlives its reader.
struct KeptMessage {
  BagConnection connection;
  std::int64_t record_ns = 0;
  std::vector<std::uint8_t> bytes;

  BagMessage View() const { return {&connection, record_ns, bytes}; }
};

inline std::vector<KeptMessage> AllMessages(BagReader& reader) {
  std::vector<KeptMessage> messages;
  while (const std::optional<BagMessage> message = reader.Next()) {
    messages.push_back({*message->connection, message->record_ns, {message->bytes.begin(), message->bytes.end()}});
  }
  return messages;
}

}  // namespace floorloc
