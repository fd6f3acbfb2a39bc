// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Images with a name for the tables.
struct ImageSet {
  std::string name;
  std::vector<std::filesystem::path> files;
};

/// Images (JPEG, PNG) of a folder, or of its subfolder images/ if there is one, sorted by name. May be empty. Throws
/// InputError when there is no such folder.
std::vector<std::filesystem::path> ImagesOf(const std::filesystem::path& folder);

/// Parses "NAME=PATH[,PATH...]"; each path is an image, a folder of images, or a folder whose subfolders have images,
/// of which the first each is used. At most `max_images` images, spread evenly over all of them. Throws InputError, or
/// std::invalid_argument for a malformed text.
ImageSet ParseImageSet(const std::string& text, int max_images);

/// Decodes a JPEG or PNG to grey levels. Throws InputError.
cv::Mat ReadImage(const std::filesystem::path& file);

}  // namespace floorloc
