// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_pictures.h"

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

bool IsPicture(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

std::string SizeText(const SizePx& size) { return std::to_string(size.first) + "x" + std::to_string(size.second); }

// The size in a picture's header; empty when it is no picture.
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
    throw InputError(first_file, "this picture and all others are no JPEG or PNG, or damaged; take them anew");
  }
  return std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void LookForBoard(const Board& board, const SizePx& size, CalibrationPicture* picture) {
  try {
    picture->view = DetectBoard(ReadGrayImage(picture->file, size.first, size.second), board);
  } catch (const InputError&) {
    picture->problem = "cannot be decoded: cut off or damaged";
    return;
  }
  if (!picture->view) {
    picture->problem = board.charuco ? "too few markers and corners of the board found"
                                     : "no board found: it must be seen whole, sharp, and with its white rim";
  }
}

}  // namespace

std::vector<std::filesystem::path> ListPictures(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (IsPicture(entry.path())) {
      files.push_back(entry.path());
    }
  }
  if (error) {
    throw InputError(folder, "is no readable folder; --images takes the folder with the pictures of the board");
  }
  if (files.empty()) {
    throw InputError(folder, "holds no JPEG or PNG pictures; put the pictures of the board there");
  }
  std::sort(files.begin(), files.end());
  return files;
}

CalibrationPictures FindBoards(const std::vector<std::filesystem::path>& files, const Board& board,
                               const PictureReadingOptions& options) {
  const std::vector<std::optional<SizePx>> sizes = ReadSizes(files);
  const SizePx common = MostFrequent(sizes, files.front());
  CalibrationPictures result{common.first, common.second, {}};
  for (const std::filesystem::path& file : files) {
    result.pictures.push_back({file, std::nullopt, ""});
  }
  ProgressBar progress("boards", static_cast<std::int64_t>(files.size()), options.progress);
  ParallelFor(static_cast<int>(files.size()), options.threads, [&](int i) {
    CalibrationPicture& picture = result.pictures[static_cast<std::size_t>(i)];
    const std::optional<SizePx>& size = sizes[static_cast<std::size_t>(i)];
    if (!size) {
      picture.problem = "is no JPEG or PNG picture, or damaged";
    } else if (*size != common) {
      picture.problem = "is " + SizeText(*size) + " pixels, most pictures are " + SizeText(common);
    } else {
      LookForBoard(board, common, &picture);
    }
    progress.Advance();
  });
  return result;
}

}  // namespace floorloc
