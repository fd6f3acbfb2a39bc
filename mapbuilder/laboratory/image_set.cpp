// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/image_set.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "core/io/image.h"
#include "core/io/image_folder.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxPixels = 100'000'000;

std::vector<fs::path> FirstOfEachFolder(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::path& entry : SortedEntries(folder)) {
    if (fs::is_directory(entry)) {
      const std::vector<fs::path> inside = ImagesOf(entry);
      images.insert(images.end(), inside.begin(), inside.begin() + (inside.empty() ? 0 : 1));
    }
  }
  return images;
}

std::vector<fs::path> ImagesAt(const fs::path& path) {
  if (fs::is_regular_file(path)) {
    return {path};
  }
  std::vector<fs::path> images = ImagesOf(path);
  if (images.empty()) {
    images = FirstOfEachFolder(path);
  }
  if (images.empty()) {
    throw InputError(path, "has no images; give a JPEG or PNG file, or a folder of such");
  }
  return images;
}

std::vector<fs::path> SpreadEvenly(const std::vector<fs::path>& files, std::size_t max_images) {
  if (files.size() <= max_images) {
    return files;
  }
  std::vector<fs::path> chosen;
  for (std::size_t i = 0; i < max_images; ++i) {
    chosen.push_back(files[i * files.size() / max_images]);
  }
  return chosen;
}

}  // namespace

std::vector<fs::path> ImagesOf(const fs::path& folder) {
  return ImageFilesIn(fs::is_directory(folder / "images") ? folder / "images" : folder);
}

ImageSet ParseImageSet(const std::string& text, int max_images) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw std::invalid_argument("'" + text + "' is not a set of images; write NAME=FOLDER");
  }
  ImageSet set;
  set.name = text.substr(0, equals);
  std::istringstream paths(text.substr(equals + 1));
  for (std::string path; std::getline(paths, path, ',');) {
    const std::vector<fs::path> images = ImagesAt(path);
    set.files.insert(set.files.end(), images.begin(), images.end());
  }
  set.files = SpreadEvenly(set.files, static_cast<std::size_t>(max_images));
  return set;
}

cv::Mat ReadImage(const fs::path& file) {
  const auto bytes = ReadBinaryFile(file);
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  if (!header) {
    throw InputError(file, "is neither a JPEG nor a PNG image; convert it");
  }
  if (std::int64_t{header->width_px} * header->height_px > kMaxPixels) {
    throw InputError(file, "has more than 100 million pixels; make it smaller");
  }
  return DecodeGray(bytes, header->width_px, header->height_px, file);
}

}  // namespace floorloc
