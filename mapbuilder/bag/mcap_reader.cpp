// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/mcap_reader.h"

#include <zlib.h>

#include <array>
#include <map>

#include "core/io/input_error.h"
#include "mapbuilder/bag/byte_cursor.h"
#include "mapbuilder/bag/decompress.h"

namespace floorloc {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kRecordHeadBytes = 9;  // opcode, length

enum Opcode : std::uint8_t {
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kDataEnd = 0x0F
};

struct Record {
  std::uint8_t opcode = 0;
  std::span<const std::uint8_t> content;
};

std::uint32_t Crc32(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

class McapReader : public BagReader {
 public:
  explicit McapReader(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    std::array<std::uint8_t, kMagic.size()> magic{};
    if (source_->Read(std::span(magic)) != magic.size() || magic != kMagic) {
      throw InputError(source_->file(), "is no MCAP file of version 0; give a .mcap, .db3 or .bag file");
    }
  }

  std::optional<BagMessage> Next() override {
    while (true) {
      const std::optional<Record> record = chunk_.empty() ? NextInFile() : NextInChunk();
      if (!record) {
        return std::nullopt;
      }
      if (std::optional<BagMessage> message = Take(*record)) {
        return message;
      }
    }
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(source_->file(), what + " at byte " + std::to_string(record_at_) +
                                          " is damaged; copy the file again, or repair it with 'mcap recover'");
  }

  void Cut(const std::string& what) {
    ended_ = true;
    Warn(source_->file().string() + ": ends " + what + " at byte " + std::to_string(source_->position()) +
         "; what comes before was read");
  }

  // Of a record outside of chunks; empty at the end.
  std::optional<Record> NextInFile() {
    while (!ended_) {
      record_at_ = source_->position();
      std::array<std::uint8_t, kRecordHeadBytes> head{};
      const std::size_t count = source_->Read(std::span(head));
      ByteCursor cursor(head);
      const std::uint8_t opcode = *cursor.Get<std::uint8_t>();
      const std::uint64_t size = *cursor.Get<std::uint64_t>();
      if (count < head.size() || opcode == 0) {
        Cut("without its end mark");
      } else if (opcode == kDataEnd || opcode == kFooter) {
        ended_ = true;
      } else if (const std::optional<Record> record = ReadRecord(opcode, size)) {
        return record;
      }
    }
    return std::nullopt;
  }

  // Empty for a record that is of no use.
  std::optional<Record> ReadRecord(std::uint8_t opcode, std::uint64_t size) {
    const bool used = opcode == kSchema || opcode == kChannel || opcode == kMessage || opcode == kChunk;
    if (!used) {
      if (!source_->Skip(size)) {
        Cut("within a record");
      }
      return std::nullopt;
    }
    if (size > kMaxBagRecordBytes) {
      Fail("a record of " + std::to_string(size) + " bytes");
    }
    const bool whole = source_->Read(size, &buffer_);
    if (!whole) {
      Cut(opcode == kChunk ? "within a chunk" : "within a record");
    }
    return whole || opcode == kChunk ? std::optional(Record{opcode, buffer_}) : std::nullopt;
  }

  std::optional<Record> NextInChunk() {
    const auto opcode = chunk_.Get<std::uint8_t>();
    const auto size = chunk_.Get<std::uint64_t>();
    const auto content = size ? chunk_.Bytes(*size) : std::nullopt;
    if (content && *opcode != kChunk) {
      return Record{*opcode, *content};
    }
    if (!ended_) {
      Fail("the chunk");
    }
    chunk_ = ByteCursor({});  // the last record of a chunk that was cut
    return Record{};
  }

  std::optional<BagMessage> Take(const Record& record) {
    ByteCursor cursor(record.content);
    switch (record.opcode) {
      case kSchema:
        TakeSchema(cursor);
        return std::nullopt;
      case kChannel:
        TakeChannel(cursor);
        return std::nullopt;
      case kChunk:
        TakeChunk(cursor);
        return std::nullopt;
      case kMessage:
        return TakeMessage(cursor);
      default:
        return std::nullopt;
    }
  }

  void TakeSchema(ByteCursor& cursor) {
    const auto id = cursor.Get<std::uint16_t>();
    const auto name = cursor.String();
    cursor.String();  // its language
    const auto definition = cursor.String();
    if (!definition) {
      Fail("a schema");
    }
    schemas_[*id] = {std::string(*name), std::string(*definition)};
  }

  void TakeChannel(ByteCursor& cursor) {
    const auto id = cursor.Get<std::uint16_t>();
    const auto schema = cursor.Get<std::uint16_t>();
    const auto topic = cursor.String();
    const auto encoding = cursor.String();
    if (!encoding) {
      Fail("a channel");
    }
    BagConnection connection;
    connection.topic = *topic;
    if (const auto found = schemas_.find(*schema); found != schemas_.end()) {
      connection.type = found->second.name;
      connection.definition = found->second.definition;
    }
    connection.serialization = *encoding == "cdr"    ? Serialization::kCdr
                               : *encoding == "ros1" ? Serialization::kRos1
                                                     : Serialization::kOther;
    channels_.emplace(*id, std::move(connection));  // each chunk may describe it again
  }

  void TakeChunk(ByteCursor& cursor) {
    cursor.Get<std::uint64_t>();  // earliest and latest time
    cursor.Get<std::uint64_t>();
    const auto size = cursor.Get<std::uint64_t>();
    const auto crc = cursor.Get<std::uint32_t>();
    const auto name = cursor.String();
    const auto compressed_size = cursor.Get<std::uint64_t>();
    if (!compressed_size) {
      if (!ended_) {
        Fail("a chunk");
      }
      return;
    }
    const Compression compression = ParseCompression(*name);
    if (compression == Compression::kUnknown || compression == Compression::kBzip2) {
      throw InputError(source_->file(), "has chunks compressed by '" + std::string(*name) +
                                            "'; convert it: mcap compress --compression zstd");
    }
    if (*size > kMaxBagRecordBytes || (!ended_ && *compressed_size > cursor.rest().size())) {
      Fail("a chunk of " + std::to_string(*size) + " bytes");
    }
    const Decompressed result = Decompress(compression, cursor.rest(), *size, &decompressed_);
    if (!ended_ && (!result.whole || (*crc != 0 && Crc32(decompressed_) != *crc))) {
      Fail(result.damage.empty() ? "the chunk" : "the chunk (" + result.damage + ")");
    }
    chunk_ = ByteCursor(decompressed_);
  }

  std::optional<BagMessage> TakeMessage(ByteCursor& cursor) {
    const auto channel = cursor.Get<std::uint16_t>();
    cursor.Get<std::uint32_t>();  // sequence
    const auto record_ns = cursor.Get<std::uint64_t>();
    if (!cursor.Get<std::uint64_t>()) {  // publish time
      Fail("a message");
    }
    const auto found = channels_.find(*channel);
    if (found == channels_.end()) {
      Fail("a message of a channel that is not described");
    }
    return BagMessage{&found->second, static_cast<std::int64_t>(*record_ns), cursor.rest()};
  }

  struct Schema {
    std::string name, definition;
  };
  std::unique_ptr<ByteSource> source_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, BagConnection> channels_;
  std::vector<std::uint8_t> buffer_;        // of the record in the file
  std::vector<std::uint8_t> decompressed_;  // of the chunk
  ByteCursor chunk_{{}};                    // what is left of it
  std::uint64_t record_at_ = 0;
  bool ended_ = false;  // of the file; what is in the chunk follows
};

}  // namespace

std::unique_ptr<BagReader> ReadMcap(std::unique_ptr<ByteSource> source) {
  return std::make_unique<McapReader>(std::move(source));
}

}  // namespace floorloc
