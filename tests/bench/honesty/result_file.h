// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/scenes/frame_record.h"

namespace floorloc {

/// The records of one floor on disk, one line each, in the order of the frames, after a title line. A killed run loses
/// at most the unwritten frames: an incomplete last line is dropped when the file is opened.
class ResultFile {
 public:
  /// Opens or creates the file. Throws InputError when that fails, when a line is damaged, or when the first line is
  /// not `title`: results of different runs must not be mixed.
  ResultFile(std::filesystem::path file, const std::string& title);

  /// Records of frames 0 to size() - 1.
  const std::vector<FrameRecord>& records() const { return records_; }
  /// Appends the records of the next frames. Throws InputError when they cannot be written.
  void Append(const std::vector<FrameRecord>& records);

 private:
  void Load(const std::string& title);

  std::filesystem::path file_;
  std::vector<FrameRecord> records_;
};

}  // namespace floorloc
