// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/surface/classes/surface_image.h"

namespace floorloc {

/// The pictures of a folder, and where what a range sensor saw of them is: FOLDER/depth/STEM.png (16-bit millimetres,
/// 0: hole) and FOLDER/intensity/STEM.png (16 or 8 bits, the sensor's unit), registered to the pictures' pixels.
struct PictureFolder {
  std::filesystem::path folder;
  std::vector<std::filesystem::path> pictures;  ///< JPEG and PNG, in the order of their numbers, then names
  bool has_range = false;
};

/// Pictures in FOLDER, or FOLDER/images if there is such. Throws InputError when there are none, or only one of depth
/// and intensity.
PictureFolder ListPictures(const std::filesystem::path& folder);

/// Reads a picture with its depth and intensity. Throws InputError.
SurfaceImage ReadPicture(const PictureFolder& folder, const std::filesystem::path& picture);

/// Folders of pictures by class: DIR/CLASS, sorted by name.
struct LabelledFolder {
  std::vector<std::string> classes;
  std::vector<PictureFolder> folders;

  bool has_range() const { return folders.front().has_range; }
};

/// Throws InputError when there are fewer than two classes, a class with fewer than two pictures, or depth for some
/// classes only.
LabelledFolder ListClasses(const std::filesystem::path& folder);

}  // namespace floorloc
