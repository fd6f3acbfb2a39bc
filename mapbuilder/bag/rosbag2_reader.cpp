// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/rosbag2_reader.h"

#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>

#include "core/io/input_error.h"
#include "mapbuilder/bag/byte_source.h"
#include "mapbuilder/bag/decompress.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::uint8_t, 4> kZstdMagic = {0x28, 0xB5, 0x2F, 0xFD};

bool IsZstd(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kZstdMagic.size() && std::equal(kZstdMagic.begin(), kZstdMagic.end(), bytes.begin());
}

// A copy of a compressed file, decompressed; removed by the destructor.
class DecompressedFile {
 public:
  explicit DecompressedFile(const fs::path& compressed) {
    std::string name = (fs::temp_directory_path() / "floorloc-bag-XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    path_ = name;
    if (descriptor < 0) {
      throw InputError(path_,
                       "cannot be created to decompress " + compressed.string() + "; set TMPDIR to another folder");
    }
    close(descriptor);
    try {
      Copy(compressed);
    } catch (...) {
      Remove();
      throw;
    }
  }
  ~DecompressedFile() { Remove(); }
  DecompressedFile(const DecompressedFile&) = delete;
  DecompressedFile& operator=(const DecompressedFile&) = delete;

  const fs::path& path() const { return path_; }

 private:
  void Copy(const fs::path& compressed) {
    const std::unique_ptr<ByteSource> source = OpenByteSource(compressed);
    std::ofstream out(path_, std::ios::binary);
    std::vector<std::uint8_t> part(1u << 20);
    for (std::size_t count = source->Read(std::span(part)); count > 0; count = source->Read(std::span(part))) {
      out.write(reinterpret_cast<const char*>(part.data()), static_cast<std::streamsize>(count));
    }
    out.close();
    if (!out) {
      throw InputError(path_, "cannot hold what " + compressed.string() +
                                  " decompresses to; free some space or set TMPDIR to another folder");
    }
  }

  void Remove() const {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }

  fs::path path_;
};

std::unique_ptr<DecompressedFile> DecompressIfNeeded(const fs::path& file) {
  std::array<std::uint8_t, kZstdMagic.size()> start{};
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(start.data()), start.size());
  return IsZstd(start) ? std::make_unique<DecompressedFile>(file) : nullptr;
}

// Whether a file has fewer pages than its header tells (sqlite.org/fileformat.html, 1.3): a copy that was cut off.
bool IsCutOff(const fs::path& file) {
  constexpr std::size_t kPageSizeAt = 16, kPageCountAt = 28, kHeaderBytes = 100;
  std::array<std::uint8_t, kHeaderBytes> header{};
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(header.data()), header.size());
  const auto big_endian = [&](std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
      value = value << 8 | header[i];
    }
    return value;
  };
  const std::uint64_t page_size = big_endian(kPageSizeAt, 2) == 1 ? 65536 : big_endian(kPageSizeAt, 2);
  std::error_code error;
  return fs::file_size(file, error) < page_size * big_endian(kPageCountAt, 4) && !error;
}

struct CloseDatabase {
  void operator()(sqlite3* handle) const { sqlite3_close(handle); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

class Rosbag2Reader : public BagReader {
 public:
  explicit Rosbag2Reader(const fs::path& file) : file_(file), decompressed_(DecompressIfNeeded(file)) {
    Open(decompressed_ ? decompressed_->path() : file);
    CheckSchema();
    ReadTopics();
    ReadDefinitions();
    messages_ = Prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY rowid");
  }

  std::optional<BagMessage> Next() override {
    if (!messages_) {
      return std::nullopt;
    }
    const int code = sqlite3_step(messages_.get());
    if (code == SQLITE_ROW) {
      ++count_;
      return Take();
    }
    if (code == SQLITE_CORRUPT && count_ > 0) {  // of a recorder that was killed, or a copy that was cut off
      Warn(file_.string() + ": is damaged after " + std::to_string(count_) + " messages; those were read");
    } else if (code != SQLITE_DONE) {
      Fail();
    }
    messages_.reset();
    return std::nullopt;
  }

 private:
  void Open(const fs::path& path) {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(handle);
    if (code != SQLITE_OK) {
      Fail();
    }
    // A bag is untrusted input: nothing in it may run code or exceed limits (SQLite, "Defense Against The Dark Arts").
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    if (IsCutOff(path)) {  // SQLite reads it in this mode only; the file stays read-only
      sqlite3_db_config(handle, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
    } else {
      sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    }
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxBagRecordBytes));
    sqlite3_exec(handle, "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;", nullptr, nullptr, nullptr);
  }

  [[noreturn]] void Fail() const {
    switch (const int code = sqlite3_errcode(database_.get()) & 0xFF; code) {
      case SQLITE_CANTOPEN:
        throw InputError(file_, "cannot be opened; check the path and its permissions");
      case SQLITE_NOTADB:
        throw InputError(file_, "is no SQLite file; give a .mcap, .db3 or .bag file");
      case SQLITE_TOOBIG:
        throw InputError(file_, "has a message of more than 256 MiB; record smaller images");
      default:
        throw InputError(file_, std::string("cannot be read (") + sqlite3_errmsg(database_.get()) +
                                    "); copy it again, or repair it with 'sqlite3 FILE .recover'");
    }
  }

  Statement Prepare(const char* sql) const {
    sqlite3_stmt* handle = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &handle, nullptr) != SQLITE_OK) {
      Fail();
    }
    return Statement(handle);
  }

  static std::string Text(const Statement& row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row.get(), column));
    return text == nullptr ? std::string()
                           : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(row.get(), column)));
  }

  // False at the end.
  bool Step(const Statement& rows) const {
    const int code = sqlite3_step(rows.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) {
      Fail();
    }
    return code == SQLITE_ROW;
  }

  // Views and virtual tables could compute without end.
  void CheckSchema() const {
    const Statement tables = Prepare(
        "SELECT COUNT(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages') "
        "AND sql NOT LIKE 'CREATE VIRTUAL%' AND sql NOT LIKE '%GENERATED%'");
    if (!Step(tables) || sqlite3_column_int(tables.get(), 0) != 2) {
      throw InputError(file_,
                       "has no tables of topics and messages, so it is no rosbag2; give a .mcap, .db3 or .bag file");
    }
  }

  void ReadTopics() {
    const Statement rows = Prepare("SELECT id, name, type, serialization_format FROM topics");
    while (Step(rows)) {
      const std::string format = Text(rows, 3);
      connections_[sqlite3_column_int64(rows.get(), 0)] = {
          Text(rows, 1), Text(rows, 2), {}, format == "cdr" ? Serialization::kCdr : Serialization::kOther};
    }
  }

  // Since ROS 2 Iron there is a table of them.
  void ReadDefinitions() {
    const Statement table =
        Prepare("SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'message_definitions'");
    if (!Step(table)) {
      return;
    }
    std::map<std::string, std::string> definitions;
    const Statement rows = Prepare("SELECT topic_type, encoded_message_definition FROM message_definitions");
    while (Step(rows)) {
      definitions[Text(rows, 0)] = Text(rows, 1);
    }
    for (auto& [id, connection] : connections_) {
      connection.definition = definitions[connection.type];
    }
  }

  BagMessage Take() {
    const auto found = connections_.find(sqlite3_column_int64(messages_.get(), 0));
    if (found == connections_.end()) {
      throw InputError(file_, "message " + std::to_string(count_) +
                                  " is of a topic that is not described; copy it again, or repair it");
    }
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(messages_.get(), 2));
    std::span<const std::uint8_t> bytes(data, static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 2)));
    if (IsZstd(bytes)) {  // no encapsulation header of CDR
      bytes = DecompressMessage(bytes);
    }
    return {&found->second, sqlite3_column_int64(messages_.get(), 1), bytes};
  }

  std::span<const std::uint8_t> DecompressMessage(std::span<const std::uint8_t> bytes) {
    const Decompressed result = Decompress(Compression::kZstd, bytes, kMaxBagRecordBytes, &message_);
    if (!result.damage.empty() || result.whole) {
      throw InputError(file_, "message " + std::to_string(count_) + " cannot be decompressed; copy the file again");
    }
    return message_;
  }

  fs::path file_;
  std::unique_ptr<DecompressedFile> decompressed_;
  Database database_;
  std::map<std::int64_t, BagConnection> connections_;
  Statement messages_;
  std::vector<std::uint8_t> message_;
  std::int64_t count_ = 0;
};

}  // namespace

std::unique_ptr<BagReader> ReadRosbag2(const std::filesystem::path& file) {
  return std::make_unique<Rosbag2Reader>(file);
}

}  // namespace floorloc
