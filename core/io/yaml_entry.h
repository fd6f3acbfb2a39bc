// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "core/io/yaml_document.h"

namespace floorloc {

/// A value of a YAML map and its key.
struct YamlEntry {
  std::string key;
  YAML::Node value;
};

/// Names of the same thing in different tools: lower case, letters and digits only.
using Names = std::initializer_list<const char*>;

/// "Camera_Matrix" and "cameraMatrix" -> "cameramatrix".
std::string NormalizedKey(const std::string& key);

/// The entry of this very key; empty when it is missing or null.
std::optional<YamlEntry> FindKey(const YAML::Node& map, const std::string& key);
/// The document's entry whose normalized key is one of the names, followed by `suffix`; the first name that is there.
std::optional<YamlEntry> FindByName(const YamlDocument& document, Names names, const std::string& suffix = "");

/// A list of numbers, a ROS or OpenCV matrix, or nested lists, one per row. Throws InputError.
std::vector<double> MatrixNumbers(const YamlDocument& document, const YamlEntry& entry);
/// The same, of this many numbers.
std::vector<double> MatrixNumbers(const YamlDocument& document, const YamlEntry& entry, std::size_t count);

}  // namespace floorloc
