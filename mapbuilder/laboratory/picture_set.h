// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Some pictures with a name for the tables.
struct PictureSet {
  std::string name;
  std::vector<std::filesystem::path> files;
};

/// The pictures (JPEG, PNG) of a folder in the order of their names; of its folder images/ where it has one. Empty when
/// there are none. Throws InputError when there is no such folder.
std::vector<std::filesystem::path> PicturesOf(const std::filesystem::path& folder);

/// From "NAME=PATH[,PATH...]"; each path is a picture, a folder of pictures, or a folder whose folders have pictures,
/// of which the first each is taken. At most `most` pictures, spread evenly over those. Throws InputError, or
/// std::invalid_argument when the text has another form.
PictureSet ParsePictureSet(const std::string& text, int most);

/// Decodes any JPEG or PNG to grey levels. Throws InputError.
cv::Mat ReadPicture(const std::filesystem::path& file);

}  // namespace floorloc
