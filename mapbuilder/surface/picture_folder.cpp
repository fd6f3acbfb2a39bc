// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/picture_folder.h"

#include <algorithm>
#include <cctype>
#include <tuple>

#include "core/io/floor_picture.h"
#include "core/io/image_folder.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// "9.jpg" comes before "10.jpg": the last number in a name counts, longer ones after shorter ones.
std::tuple<std::size_t, std::string, std::string> Order(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) {
    --begin;
  }
  std::string number = stem.substr(begin);
  number.erase(0, std::min(number.find_first_not_of('0'), number.size()));
  return {number.size(), number, file.filename().string()};
}

std::vector<fs::path> PicturesIn(const fs::path& folder) {
  std::vector<fs::path> pictures = ImageFilesIn(folder);
  std::sort(pictures.begin(), pictures.end(), [](const fs::path& a, const fs::path& b) { return Order(a) < Order(b); });
  return pictures;
}

bool IsReserved(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == "depth" || name == "intensity" || name == "images" || name.starts_with('.');
}

void RequireClasses(const fs::path& folder, const LabelledFolder& found) {
  if (found.classes.empty()) {
    throw InputError(folder, "has no folders of pictures; put the pictures of each class into a folder of its name");
  }
  if (found.classes.size() == 1) {
    throw InputError(folder,
                     "has one class only (" + found.classes.front() + "); a second one is needed to tell apart");
  }
  for (const PictureFolder& pictures : found.folders) {
    if (pictures.pictures.size() < 2) {
      throw InputError(pictures.folder, "has one picture only; give at least two, better twenty, of every class");
    }
    if (pictures.has_range != found.has_range()) {
      throw InputError(pictures.has_range ? found.folders.front().folder : pictures.folder,
                       "has no depth/ and intensity/ while other classes have; give them for all classes or for none");
    }
  }
}

}  // namespace

PictureFolder ListPictures(const fs::path& folder) {
  PictureFolder found;
  found.folder = folder;
  found.pictures = PicturesIn(fs::is_directory(folder / "images") ? folder / "images" : folder);
  if (found.pictures.empty()) {
    throw InputError(folder, "has no JPEG or PNG pictures; check the path");
  }
  const bool has_depth = fs::is_directory(folder / "depth");
  if (has_depth != fs::is_directory(folder / "intensity")) {
    throw InputError(folder, std::string("has ") + (has_depth ? "depth/" : "intensity/") + " without " +
                                 (has_depth ? "intensity/" : "depth/") + "; give both or none");
  }
  found.has_range = has_depth;
  return found;
}

SurfaceImage ReadPicture(const PictureFolder& folder, const fs::path& picture) {
  SurfaceImage image;
  image.color = ReadPictureOfAnySize(picture);
  if (folder.has_range) {
    const std::string name = picture.stem().string() + ".png";
    image.depth_mm = ReadMeasuredImage(folder.folder / "depth" / name, {image.color.size(), "depth", false});
    image.intensity = ReadMeasuredImage(folder.folder / "intensity" / name, {image.color.size(), "intensity", true});
  }
  return image;
}

LabelledFolder ListClasses(const fs::path& folder) {
  LabelledFolder found;
  for (const fs::path& entry : SortedEntries(folder)) {
    if (fs::is_directory(entry) && !IsReserved(entry)) {
      found.classes.push_back(entry.filename().string());
      found.folders.push_back(ListPictures(entry));
    }
  }
  RequireClasses(folder, found);
  return found;
}

}  // namespace floorloc
