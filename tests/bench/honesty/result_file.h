// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/scenes/frame_record.h"

namespace floorloc {

/// The records of one floor on disk, a line each, in the order of the frames. The first line says what they belong to.
/// A killed run loses at most the frames it was at: a torn last line is dropped when the file is opened.
class ResultFile {
 public:
  /// Opens or makes the file. Throws InputError when it can't, when a line is damaged, or when its first line is not
  /// `title`: results of different runs must not be mixed.
  ResultFile(std::filesystem::path file, const std::string& title);

  /// Records of frames 0 to size() - 1.
  const std::vector<FrameRecord>& records() const { return records_; }
  /// The next frames. Throws InputError when they can't be written.
  void Append(const std::vector<FrameRecord>& records);

 private:
  void Load(const std::string& title);

  std::filesystem::path file_;
  std::vector<FrameRecord> records_;
};

}  // namespace floorloc
