// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// A picture, and the board in it or why there is none.
struct CalibrationPicture {
  std::filesystem::path file;
  std::optional<BoardView> view;
  std::string problem;  ///< empty when view is there
};

/// The pictures of one camera: all of one size.
struct CalibrationPictures {
  int width_px = 0;
  int height_px = 0;
  std::vector<CalibrationPicture> pictures;
};

/// The JPEG and PNG files of a folder in alphabetical order. Throws InputError when there are none.
std::vector<std::filesystem::path> ListPictures(const std::filesystem::path& folder);

struct PictureReadingOptions {
  int threads = 0;  ///< 0: one per core
  ProgressOutput progress;
};

/// Looks for the board in every picture. Pictures that cannot be read, or whose size is not that of most, have a
/// problem instead of a view. Throws InputError when no picture can be read.
CalibrationPictures FindBoards(const std::vector<std::filesystem::path>& files, const Board& board,
                               const PictureReadingOptions& options);

}  // namespace floorloc
