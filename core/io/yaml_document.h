// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/io/input_error.h"

namespace floorloc {

/// A YAML map, at most 1 MiB, whose errors (InputError) name the file and, if known, the line. A key that is given
/// twice is refused: parsers differ in which one they take.
class YamlDocument {
 public:
  YamlDocument(const std::string& text, const std::filesystem::path& source);

  const YAML::Node& root() const { return root_; }
  const std::filesystem::path& source() const { return source_; }

  /// The line is left out when the mark has none.
  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& reason) const;

  /// Throws when the key is missing or null.
  YAML::Node Get(const YAML::Node& map, const std::string& key) const;
  bool Has(const std::string& key) const;

  double Number(const YAML::Node& value, const std::string& key) const;
  /// 0 when the key is missing or null.
  double OptionalNumber(const std::string& key) const;
  int Pixels(const std::string& key) const { return Pixels(Get(root_, key), key); }
  int Pixels(const YAML::Node& value, const std::string& key) const;
  std::string Text(const YAML::Node& value, const std::string& key) const;

  /// A list of numbers, or a ROS or OpenCV matrix {rows, cols, data}.
  std::vector<double> Numbers(const std::string& key) const { return Numbers(Get(root_, key), key); }
  std::vector<double> Numbers(const YAML::Node& value, const std::string& key) const;

  template <std::size_t kCount>
  std::array<double, kCount> FixedNumbers(const std::string& key) const {
    const std::vector<double> numbers = Numbers(key);
    if (numbers.size() != kCount) {
      Fail(root_[key].Mark(), key + " must have " + std::to_string(kCount) + " numbers but has " +
                                  std::to_string(numbers.size()) + "; correct it");
    }
    std::array<double, kCount> result{};
    std::copy(numbers.begin(), numbers.end(), result.begin());
    return result;
  }

 private:
  void CheckShape(const YAML::Node& matrix, const std::string& key, std::size_t count) const;

  std::filesystem::path source_;
  YAML::Node root_;
};

}  // namespace floorloc
