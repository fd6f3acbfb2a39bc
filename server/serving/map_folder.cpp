// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_folder.h"

#include <algorithm>

#include "core/io/input_error.h"
#include "core/map/map_database.h"

namespace floorloc {

std::vector<std::filesystem::path> ListMapFiles(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  if (error) {
    throw InputError(folder, "the maps folder cannot be read (" + error.message() + "); check --maps");
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : entries) {
    if (entry.path().extension() == ".floormap" && entry.is_regular_file(error)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string PeekMapVersion(const std::filesystem::path& file) {
  try {
    return MapDatabase(file).ReadInfo().content_version;
  } catch (const std::exception&) {
    return "";
  }
}

}  // namespace floorloc
