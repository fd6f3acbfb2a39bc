// SPDX-License-Identifier: Apache-2.0
#include "core/io/yaml_document.h"

#include <yaml-cpp/eventhandler.h>

#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "core/io/delimited_text.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxTextBytes = std::size_t{1} << 20;

// Finds keys that a map has twice, which YAML::Load accepts silently. It follows the parser's events, not the nodes:
// aliases can make a small text a huge tree.
class RepeatedKeyFinder : public YAML::EventHandler {
 public:
  const std::optional<std::pair<YAML::Mark, std::string>>& repeated() const { return repeated_; }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override { Pass(); }
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override { Pass(); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    if (!open_.empty() && open_.back().expects_key && !open_.back().keys.insert(value).second && !repeated_) {
      repeated_.emplace(mark, value);
    }
    Pass();
  }
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({false, false, {}});
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    open_.push_back({true, true, {}});
  }
  void OnMapEnd() override { Close(); }

 private:
  struct Collection {
    bool is_map = false;
    bool expects_key = false;
    std::set<std::string> keys;
  };

  // A node ended: in a map, keys and values alternate.
  void Pass() {
    if (!open_.empty() && open_.back().is_map) {
      open_.back().expects_key = !open_.back().expects_key;
    }
  }
  void Close() {
    open_.pop_back();
    Pass();
  }

  std::vector<Collection> open_;
  std::optional<std::pair<YAML::Mark, std::string>> repeated_;
};

}  // namespace

YamlDocument::YamlDocument(const std::string& text, const std::filesystem::path& source) : source_(source) {
  if (text.size() > kMaxTextBytes) {
    throw InputError(source_, "is larger than 1 MiB; check that it is the right file");
  }
  RepeatedKeyFinder finder;
  try {
    std::istringstream stream(text);
    YAML::Parser(stream).HandleNextDocument(finder);
    root_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    Fail(error.mark, "is not valid YAML (" + error.msg + "); correct the line");
  }
  if (!root_.IsMap()) {
    throw InputError(source_, "has no YAML keys; write lines of the form 'key: value'");
  }
  if (finder.repeated()) {
    Fail(finder.repeated()->first, "the key '" + finder.repeated()->second + "' is given twice; delete one of the two");
  }
}

void YamlDocument::Fail(const YAML::Mark& mark, const std::string& reason) const {
  if (mark.is_null() || mark.line < 0) {
    throw InputError(source_, reason);
  }
  throw InputError(source_, mark.line + 1, reason);
}

YAML::Node YamlDocument::Get(const YAML::Node& map, const std::string& key) const {
  const YAML::Node value = map[key];
  if (!value.IsDefined() || value.IsNull()) {
    throw InputError(source_, "the key '" + key + "' is missing; add it");
  }
  return value;
}

bool YamlDocument::Has(const std::string& key) const {
  const YAML::Node value = root_[key];
  return value.IsDefined() && !value.IsNull();
}

double YamlDocument::Number(const YAML::Node& value, const std::string& key) const {
  const std::optional<double> number = value.IsScalar() ? ParseNumber(value.Scalar()) : std::nullopt;
  if (!number) {
    Fail(value.Mark(), key + " must be a finite number; correct it");
  }
  return *number;
}

int YamlDocument::Pixels(const YAML::Node& value, const std::string& key) const {
  const double number = Number(value, key);
  if (number != std::floor(number) || std::abs(number) > 1e9) {
    Fail(value.Mark(), key + " must be a whole number of pixels; correct it");
  }
  return static_cast<int>(number);
}

double YamlDocument::OptionalNumber(const std::string& key) const {
  return Has(key) ? Number(Get(root_, key), key) : 0.0;
}

std::string YamlDocument::Text(const YAML::Node& value, const std::string& key) const {
  if (!value.IsScalar()) {
    Fail(value.Mark(), key + " must be a string; correct it");
  }
  return value.Scalar();
}

std::vector<double> YamlDocument::Numbers(const YAML::Node& value, const std::string& key) const {
  const YAML::Node list = value.IsMap() ? Get(value, "data") : value;
  if (!list.IsSequence()) {
    Fail(list.Mark(), key + " must be a list of numbers, or a matrix with rows, cols and data; correct it");
  }
  std::vector<double> numbers;
  for (const YAML::Node& item : list) {
    numbers.push_back(Number(item, key));
  }
  if (value.IsMap()) {
    CheckShape(value, key, numbers.size());
  }
  return numbers;
}

void YamlDocument::CheckShape(const YAML::Node& matrix, const std::string& key, std::size_t count) const {
  const double rows = Number(Get(matrix, "rows"), key + ".rows");
  const double cols = Number(Get(matrix, "cols"), key + ".cols");
  if (rows * cols != static_cast<double>(count)) {
    Fail(matrix.Mark(),
         key + ": rows x cols does not agree with the " + std::to_string(count) + " numbers of data; correct it");
  }
}

}  // namespace floorloc
