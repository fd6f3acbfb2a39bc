// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"
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

struct ImageReadingOptions {
  int threads = 0;  ///< 0: one per core
  ProgressOutput progress;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Detects the board in every image. Images that are unreadable or whose size differs from most others have a problem
/// instead of a view. Throws InputError when no image is readable.
CalibrationImages FindBoards(const std::vector<std::filesystem::path>& files, const Board& board,
                             const ImageReadingOptions& options);

}  // namespace floorloc
