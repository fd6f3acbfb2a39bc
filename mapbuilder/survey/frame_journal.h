// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "core/map/content_hash.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/batch/build_journal.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Adds an identification of this executable: entries written by another build of it are not used.
ContentHash& AddProgram(ContentHash* hash);
/// Adds a file's path, size and modification time.
ContentHash& AddFile(const std::filesystem::path& file, ContentHash* hash);

/// Extraction results of frames in the journal of a build. Thread-safe.
class FrameJournal {
 public:
  /// Keeps references to the journal and the surveys.
  FrameJournal(BuildJournal* journal, const std::vector<LoadedSurvey>& surveys, const ExtractorOptions& extractor);

  /// Fills in the results of extraction; false when the journal has none for this frame.
  bool Restore(BuildFrame* frame);
  void Store(const BuildFrame& frame);
  int restored() const { return restored_; }

 private:
  std::string KeyOf(const BuildFrame& frame) const;

  BuildJournal* journal_;
  const std::vector<LoadedSurvey>& surveys_;
  std::vector<std::string> survey_keys_;
  std::atomic<int> restored_ = 0;
};

}  // namespace floorloc
