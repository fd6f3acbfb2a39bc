// SPDX-License-Identifier: Apache-2.0
#include "core/io/yaml_entry.h"

#include <cctype>

namespace floorloc {

std::string NormalizedKey(const std::string& key) {
  std::string text;
  for (const char letter : key) {
    const auto c = static_cast<unsigned char>(letter);
    if (std::isalnum(c) != 0) {
      text += static_cast<char>(std::tolower(c));
    }
  }
  return text;
}

std::optional<YamlEntry> FindByName(const YamlDocument& document, Names names, const std::string& suffix) {
  for (const char* name : names) {
    for (const auto& entry : document.root()) {
      if (entry.first.IsScalar() && NormalizedKey(entry.first.Scalar()) == name + suffix && !entry.second.IsNull()) {
        return YamlEntry{entry.first.Scalar(), entry.second};
      }
    }
  }
  return std::nullopt;
}

std::vector<double> MatrixNumbers(const YamlDocument& document, const YamlEntry& entry) {
  if (!entry.value.IsSequence() || entry.value.size() == 0 || !entry.value[0].IsSequence()) {
    return document.Numbers(entry.value, entry.key);
  }
  std::vector<double> numbers;
  for (const YAML::Node& row : entry.value) {
    const std::vector<double> more = document.Numbers(row, entry.key);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  return numbers;
}

std::vector<double> MatrixNumbers(const YamlDocument& document, const YamlEntry& entry, std::size_t count) {
  std::vector<double> numbers = MatrixNumbers(document, entry);
  if (numbers.size() != count) {
    document.Fail(entry.value.Mark(), entry.key + " must have " + std::to_string(count) + " numbers but has " +
                                          std::to_string(numbers.size()) + "; correct it");
  }
  return numbers;
}

std::optional<YamlEntry> FindKey(const YAML::Node& map, const std::string& key) {
  const YAML::Node value = map[key];
  return value.IsDefined() && !value.IsNull() ? std::optional(YamlEntry{key, value}) : std::nullopt;
}

}  // namespace floorloc
