// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Some images with a name for the tables.
struct ImageSet {
  std::string name;
  std::vector<std::filesystem::path> files;
};

/// The images (JPEG, PNG) of a folder in the order of their names; of its folder images/ where it has one. Empty when
/// there are none. Throws InputError when there is no such folder.
std::vector<std::filesystem::path> ImagesOf(const std::filesystem::path& folder);

/// From "NAME=PATH[,PATH...]"; each path is an image, a folder of images, or a folder whose folders have images,
/// of which the first each is taken. At most `max_images` images, spread evenly over those. Throws InputError, or
/// std::invalid_argument when the text has another form.
ImageSet ParseImageSet(const std::string& text, int max_images);

/// Decodes any JPEG or PNG to grey levels. Throws InputError.
cv::Mat ReadImage(const std::filesystem::path& file);

}  // namespace floorloc
