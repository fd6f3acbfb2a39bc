// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_images.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <system_error>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/fiducials/board_detection.h"

namespace floorloc {
namespace {

using SizePx = std::pair<int, int>;

bool IsImage(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

std::string SizeText(const SizePx& size) { return std::to_string(size.first) + "x" + std::to_string(size.second); }

// Image size from the file header; empty when it is not an image.
std::optional<SizePx> ReadSize(const std::filesystem::path& file) {
  const std::optional<ImageHeader> header = ProbeImage(ReadBinaryFile(file));
  return header ? std::optional<SizePx>({header->width_px, header->height_px}) : std::nullopt;
}

std::vector<std::optional<SizePx>> ReadSizes(const std::vector<std::filesystem::path>& files) {
  std::vector<std::optional<SizePx>> sizes;
  for (const std::filesystem::path& file : files) {
    sizes.push_back(ReadSize(file));
  }
  return sizes;
}

SizePx MostFrequent(const std::vector<std::optional<SizePx>>& sizes, const std::filesystem::path& first_file) {
  std::map<SizePx, int> count;
  for (const std::optional<SizePx>& size : sizes) {
    if (size) {
      ++count[*size];
    }
  }
  if (count.empty()) {
    throw InputError(first_file, "this image and all others are not JPEG or PNG, or damaged; take them again");
  }
  return std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void DetectBoardInImage(const Board& board, const SizePx& size, CalibrationImage* image) {
  try {
    image->view = DetectBoard(ReadGrayImage(image->file, size.first, size.second), board);
  } catch (const InputError&) {
    image->problem = "cannot be decoded: cut off or damaged";
    return;
  }
  if (!image->view) {
    image->problem = board.charuco ? "too few markers and corners of the board found"
                                   : "no board found: it must be visible as a whole, sharp, and with its white margin";
  }
}

}  // namespace

std::vector<std::filesystem::path> ListImages(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (IsImage(entry.path())) {
      files.push_back(entry.path());
    }
  }
  if (error) {
    throw InputError(folder, "is not a readable folder; --images takes the folder with the images of the board");
  }
  if (files.empty()) {
    throw InputError(folder, "contains no JPEG or PNG images; put the images of the board there");
  }
  std::sort(files.begin(), files.end());
  return files;
}

CalibrationImages FindBoards(const std::vector<std::filesystem::path>& files, const Board& board,
                             const RunOptions& run) {
  run.Check();
  const std::vector<std::optional<SizePx>> sizes = ReadSizes(files);
  const SizePx common = MostFrequent(sizes, files.front());
  CalibrationImages result{common.first, common.second, {}};
  for (const std::filesystem::path& file : files) {
    result.images.push_back({file, std::nullopt, ""});
  }
  ProgressBar progress("boards", static_cast<std::int64_t>(files.size()), run.progress);
  ParallelFor(static_cast<int>(files.size()), run.threads, [&](int i) {
    CalibrationImage& image = result.images[static_cast<std::size_t>(i)];
    const std::optional<SizePx>& size = sizes[static_cast<std::size_t>(i)];
    if (!size) {
      image.problem = "is not a JPEG or PNG image, or damaged";
    } else if (*size != common) {
      image.problem = "is " + SizeText(*size) + " pixels, most images are " + SizeText(common);
    } else {
      DetectBoardInImage(board, common, &image);
    }
    progress.Advance();
  });
  return result;
}

}  // namespace floorloc
