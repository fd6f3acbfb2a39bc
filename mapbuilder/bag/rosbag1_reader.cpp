// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/rosbag1_reader.h"

#include <array>
#include <cstring>
#include <map>

#include "core/io/input_error.h"
#include "mapbuilder/bag/byte_cursor.h"
#include "mapbuilder/bag/decompress.h"

namespace floorloc {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMaxHeaderBytes = 1u << 20;

enum Op : std::uint8_t { kMessage = 0x02, kChunk = 0x05, kConnection = 0x07 };

// The fields "name=value" of a record's header, or of a connection's data.
class Fields {
 public:
  // False when they are damaged.
  bool Parse(std::span<const std::uint8_t> bytes) {
    fields_.clear();
    ByteCursor cursor(bytes);
    while (!cursor.empty()) {
      const auto field = cursor.String();
      const std::size_t equals = field ? field->find('=') : std::string_view::npos;
      if (equals == std::string_view::npos) {
        return false;
      }
      fields_[std::string(field->substr(0, equals))] = std::string(field->substr(equals + 1));
    }
    return true;
  }

  template <typename Number>
  std::optional<Number> Get(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end() || found->second.size() != sizeof(Number)) {
      return std::nullopt;
    }
    Number number;
    std::memcpy(&number, found->second.data(), sizeof(Number));
    return number;
  }

  std::string Text(const std::string& name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? std::string() : found->second;
  }

 private:
  std::map<std::string, std::string> fields_;
};

class Rosbag1Reader : public BagReader {
 public:
  explicit Rosbag1Reader(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {
    std::array<std::uint8_t, kMagic.size()> magic{};
    if (source_->Read(std::span(magic)) != magic.size() ||
        std::memcmp(magic.data(), kMagic.data(), kMagic.size()) != 0) {
      throw InputError(source_->file(),
                       "is no bag of version 2.0; migrate it with 'rosbag fix', or give a .mcap or .db3");
    }
  }

  std::optional<BagMessage> Next() override {
    while (true) {
      const bool in_chunk = !chunk_.empty();
      if (!in_chunk && ended_) {
        return std::nullopt;
      }
      if (in_chunk ? NextInChunk() : NextInFile()) {
        if (std::optional<BagMessage> message = Take()) {
          return message;
        }
      }
    }
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(source_->file(), what + " at byte " + std::to_string(record_at_) +
                                          " is damaged; copy the file again, or repair it with 'rosbag fix'");
  }

  void Cut(const std::string& what) {
    ended_ = true;
    Warn(source_->file().string() + ": ends within " + what + " at byte " + std::to_string(source_->position()) +
         "; what comes before was read");
  }

  // Length of the next part in the file; empty at the end.
  std::optional<std::uint32_t> ReadLength() {
    std::array<std::uint8_t, sizeof(std::uint32_t)> bytes{};
    const std::size_t count = source_->Read(std::span(bytes));
    if (count < bytes.size()) {
      ended_ = true;
      if (count > 0) {
        Cut("a record");
      }
      return std::nullopt;
    }
    return ByteCursor(bytes).Get<std::uint32_t>();
  }

  // Reads a record of use into header_ and data_.
  bool NextInFile() {
    record_at_ = source_->position();
    const auto header_size = ReadLength();
    if (!header_size) {
      return false;
    }
    if (*header_size > kMaxHeaderBytes) {
      Fail("a record with a header of " + std::to_string(*header_size) + " bytes");
    }
    if (!source_->Read(*header_size, &buffer_)) {
      Cut("a record");
      return false;
    }
    if (!header_.Parse(buffer_)) {
      Fail("a record");
    }
    const auto data_size = ReadLength();
    if (!data_size) {
      if (ended_ && warnings().empty()) {
        Cut("a record");
      }
      return false;
    }
    return ReadData(*data_size);
  }

  bool ReadData(std::uint32_t size) {
    const auto op = header_.Get<std::uint8_t>("op");
    if (op != kMessage && op != kChunk && op != kConnection) {
      if (!source_->Skip(size)) {
        Cut("a record");
      }
      return false;
    }
    if (size > kMaxBagRecordBytes) {
      Fail("a record of " + std::to_string(size) + " bytes");
    }
    const bool whole = source_->Read(size, &buffer_);
    if (!whole) {
      Cut(op == kChunk ? "a chunk" : "a record");
    }
    data_ = buffer_;
    return whole || op == kChunk;
  }

  bool NextInChunk() {
    const auto header = chunk_.String();
    const auto data = header ? chunk_.String() : std::nullopt;
    const auto bytes = [](std::string_view text) {
      return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    };
    if (data && header_.Parse(bytes(*header)) && header_.Get<std::uint8_t>("op") != kChunk) {
      data_ = bytes(*data);
      return true;
    }
    if (!ended_) {
      Fail("the chunk");
    }
    chunk_ = ByteCursor({});  // the last record of a chunk that was cut
    return false;
  }

  std::optional<BagMessage> Take() {
    const auto op = header_.Get<std::uint8_t>("op");
    if (op == kChunk) {
      TakeChunk();
    } else if (op == kConnection) {
      TakeConnection();
    } else if (op == kMessage) {
      return TakeMessage();
    }
    return std::nullopt;
  }

  void TakeChunk() {
    const std::string name = header_.Text("compression");
    const auto size = header_.Get<std::uint32_t>("size");
    const Compression compression = ParseCompression(name);
    if (!size || *size > kMaxBagRecordBytes) {
      Fail("a chunk");
    }
    if (compression == Compression::kUnknown || compression == Compression::kZstd) {
      throw InputError(source_->file(),
                       "has chunks compressed by '" + name + "', which no ROS 1 writes; convert it: rosbag decompress");
    }
    const Decompressed result = Decompress(compression, data_, *size, &decompressed_);
    if (!ended_ && !result.whole) {
      Fail(result.damage.empty() ? "the chunk" : "the chunk (" + result.damage + ")");
    }
    chunk_ = ByteCursor(decompressed_);
  }

  void TakeConnection() {
    const auto id = header_.Get<std::uint32_t>("conn");
    Fields fields;
    if (!id || !fields.Parse(data_)) {
      Fail("a connection");
    }
    connections_.try_emplace(*id, BagConnection{header_.Text("topic"), fields.Text("type"),
                                                fields.Text("message_definition"), Serialization::kRos1});
  }

  std::optional<BagMessage> TakeMessage() {
    constexpr std::int64_t kNsPerSecond = 1'000'000'000;
    const auto id = header_.Get<std::uint32_t>("conn");
    const auto time = header_.Get<std::uint64_t>("time");  // seconds, nanoseconds
    const auto found = id ? connections_.find(*id) : connections_.end();
    if (!time || found == connections_.end()) {
      Fail("a message");
    }
    const auto seconds = static_cast<std::int64_t>(*time & 0xFFFFFFFF);
    const auto nanoseconds = static_cast<std::int64_t>(*time >> 32);
    return BagMessage{&found->second, seconds * kNsPerSecond + nanoseconds, data_};
  }

  std::unique_ptr<ByteSource> source_;
  std::map<std::uint32_t, BagConnection> connections_;
  Fields header_;
  std::span<const std::uint8_t> data_;
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint8_t> decompressed_;
  ByteCursor chunk_{{}};
  std::uint64_t record_at_ = 0;
  bool ended_ = false;  // of the file; what is in the chunk follows
};

}  // namespace

std::unique_ptr<BagReader> ReadRosbag1(std::unique_ptr<ByteSource> source) {
  return std::make_unique<Rosbag1Reader>(std::move(source));
}

}  // namespace floorloc
