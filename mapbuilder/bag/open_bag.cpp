// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/open_bag.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "core/io/image_folder.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/yaml_document.h"
#include "core/io/yaml_entry.h"
#include "mapbuilder/bag/mcap_reader.h"
#include "mapbuilder/bag/rosbag1_reader.h"
#include "mapbuilder/bag/rosbag2_reader.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

enum class BagKind { kNone, kSqlite, kMcap, kRosbag1 };

// By the first bytes, of what is decompressed.
BagKind KindOf(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return BagKind::kNone;
  }
  std::array<std::uint8_t, 16> start{};
  const std::size_t count = OpenByteSource(file)->Read(std::span(start));
  const std::string_view text(reinterpret_cast<const char*>(start.data()), count);
  return text.starts_with("SQLite format 3") ? BagKind::kSqlite
         : text.starts_with("\x89MCAP")      ? BagKind::kMcap
         : text.starts_with("#ROSBAG V")     ? BagKind::kRosbag1
                                             : BagKind::kNone;
}

bool HasBagName(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const char* ending : {".db3", ".db3.zstd", ".mcap", ".mcap.zstd", ".bag", ".bag.active"}) {
    if (name.ends_with(ending)) {
      return true;
    }
  }
  return false;
}

// Numbers in names count as numbers: name_10.db3 is later than name_9.db3.
bool NaturallyLess(const fs::path& a, const fs::path& b) {
  const auto padded = [](const std::string& name) {
    constexpr std::size_t kDigits = 20;
    std::string key, number;
    for (const char c : name + '\0') {
      if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
        number += c;
        continue;
      }
      if (!number.empty()) {
        key += std::string(kDigits - std::min(kDigits, number.size()), '0') + number;
        number.clear();
      }
      key += c;
    }
    return key;
  };
  return padded(a.filename().string()) < padded(b.filename().string());
}

// The files that metadata.yaml lists; paths are relative to it, in early versions to the folder above.
std::vector<fs::path> ListedFiles(const fs::path& folder) {
  const fs::path metadata = folder / "metadata.yaml";
  const YamlDocument document(ReadTextFile(metadata), metadata);
  const YAML::Node bag = document.Get(document.root(), "rosbag2_bagfile_information");
  const std::optional<YamlEntry> listed =
      bag.IsMap() ? FindKey(bag, "relative_file_paths") : std::optional<YamlEntry>();
  std::vector<fs::path> files;
  for (std::size_t i = 0; listed && listed->value.IsSequence() && i < listed->value.size(); ++i) {
    const YAML::Node value = listed->value[i];
    const fs::path name = fs::path(document.Text(value, "relative_file_paths")).filename();
    const fs::path compressed = name.string() + ".zstd";
    files.push_back(!fs::exists(folder / name) && fs::exists(folder / compressed) ? folder / compressed
                                                                                  : folder / name);
  }
  if (files.empty()) {
    throw InputError(metadata,
                     "lists no files in relative_file_paths; delete it, and the files of the folder are read");
  }
  for (const fs::path& file : files) {
    if (!fs::is_regular_file(file)) {
      throw InputError(metadata, "lists " + file.filename().string() +
                                     ", which is missing; add it, or delete metadata.yaml to read the others");
    }
  }
  return files;
}

std::vector<fs::path> FilesByName(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& entry : SortedEntries(folder)) {
    if (HasBagName(entry)) {
      files.push_back(entry);
    }
  }
  std::sort(files.begin(), files.end(), NaturallyLess);
  return files;
}

std::unique_ptr<BagReader> OpenFile(const fs::path& file) {
  switch (KindOf(file)) {
    case BagKind::kSqlite:
      return ReadRosbag2(file);
    case BagKind::kMcap:
      return ReadMcap(OpenByteSource(file));
    case BagKind::kRosbag1:
      return ReadRosbag1(OpenByteSource(file));
    case BagKind::kNone:
      break;
  }
  std::error_code ignored;
  throw InputError(file, fs::exists(file, ignored)
                             ? "is no bag; give a .mcap, .db3 or .bag file, or their folder"
                             : "does not exist; give a .mcap, .db3 or .bag file, or their folder");
}

// Reads files one after the other.
class SplitReader : public BagReader {
 public:
  explicit SplitReader(std::vector<fs::path> files) : files_(std::move(files)), reader_(OpenFile(files_.front())) {}

  std::optional<BagMessage> Next() override {
    while (reader_) {
      if (std::optional<BagMessage> message = reader_->Next()) {
        return message;
      }
      for (const std::string& warning : reader_->warnings()) {
        Warn(warning);
      }
      ++next_;
      reader_ = next_ < files_.size() ? OpenFile(files_[next_]) : nullptr;
    }
    return std::nullopt;
  }

 private:
  std::vector<fs::path> files_;
  std::size_t next_ = 0;
  std::unique_ptr<BagReader> reader_;
};

}  // namespace

std::string PlainType(const std::string& type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

bool IsBag(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) {
    const BagKind kind = KindOf(path);
    return kind != BagKind::kNone && (kind != BagKind::kSqlite || HasBagName(path));  // a map is an SQLite file, too
  }
  return fs::exists(path / "metadata.yaml", ignored) || !FilesByName(path).empty();
}

std::vector<std::filesystem::path> BagFiles(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) {
    return {path};
  }
  std::vector<fs::path> files = fs::exists(path / "metadata.yaml", ignored) ? ListedFiles(path) : FilesByName(path);
  if (files.empty()) {
    throw InputError(path, "holds no bag; give a .mcap, .db3 or .bag file, or their folder");
  }
  return files;
}

std::unique_ptr<BagReader> OpenBag(const std::filesystem::path& path) {
  return std::make_unique<SplitReader>(BagFiles(path));
}

}  // namespace floorloc
