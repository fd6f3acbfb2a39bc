// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/compression.h"

#include <algorithm>
#include <optional>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/io/jpeg_quality.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

std::optional<int> QualityOfFile(const std::filesystem::path& file) {
  try {
    return EstimateJpegQuality(ReadBinaryFile(file));
  } catch (const InputError&) {
    return std::nullopt;  // reported as unreadable
  }
}

// Median over some of the survey's images; empty: no JPEGs.
std::optional<int> QualityOfSurvey(const Survey& survey, int samples) {
  std::vector<int> qualities;
  const std::size_t step = std::max<std::size_t>(1, survey.frames.size() / static_cast<std::size_t>(samples));
  for (std::size_t i = 0; i < survey.frames.size(); i += step) {
    if (const std::optional<int> quality = QualityOfFile(survey.ImagePath(survey.frames[i]))) {
      qualities.push_back(*quality);
    }
  }
  if (qualities.empty()) {
    return std::nullopt;
  }
  const auto middle = qualities.begin() + static_cast<std::ptrdiff_t>(qualities.size() / 2);
  std::nth_element(qualities.begin(), middle, qualities.end());
  return *middle;
}

}  // namespace

void CompressionOptions::Check() const {
  RequireOption(min_jpeg_quality >= 0 && min_jpeg_quality <= 100, "min_jpeg_quality must be 0 to 100");
  RequireOption(sampled_images >= 1, "sampled_images must be positive");
}

std::vector<std::string> FindPoorCompression(const FrameSet& set, const CompressionOptions& options) {
  options.Check();
  std::vector<std::string> warnings;
  for (const LoadedSurvey& loaded : set.surveys) {
    const std::optional<int> quality = QualityOfSurvey(loaded.survey, options.sampled_images);
    if (quality && *quality < options.min_jpeg_quality) {
      warnings.push_back(loaded.survey.folder.string() + ": " + CompressedTooMuch(*quality));
    }
  }
  return warnings;
}

}  // namespace floorloc
