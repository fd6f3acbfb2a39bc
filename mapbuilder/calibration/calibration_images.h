// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// An image with the detected board, or the reason why there is none.
struct CalibrationImage {
  std::filesystem::path file;
  std::optional<BoardView> view;
  std::string problem;  ///< empty if there is a view
};

/// Images of one camera, all of one size.
struct CalibrationImages {
  int width_px = 0;
  int height_px = 0;
  std::vector<CalibrationImage> images;
};

/// JPEG and PNG files of a folder, sorted by name. Throws InputError when there are none.
std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder);

/// Detects the board in every image. Images that are unreadable or whose size differs from most others have a problem
/// instead of a view. Throws InputError when no image is readable.
CalibrationImages FindBoards(const std::vector<std::filesystem::path>& files, const Board& board,
                             const RunOptions& run);

}  // namespace floorloc
