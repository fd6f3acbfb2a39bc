// SPDX-License-Identifier: Apache-2.0
#include "core/io/image_folder.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

bool IsImage(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace

std::vector<fs::path> SortedEntries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) {
    throw InputError(folder, "cannot be read as a folder (" + error.message() + "); check the path");
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> ImageFilesIn(const fs::path& folder) {
  std::vector<fs::path> images = SortedEntries(folder);
  std::erase_if(images, [](const fs::path& file) { return !fs::is_regular_file(file) || !IsImage(file); });
  return images;
}

}  // namespace floorloc
