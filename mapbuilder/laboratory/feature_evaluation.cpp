// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/feature_evaluation.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/vision/surf/surf.h"
#include "mapbuilder/laboratory/feature_tables.h"
#include "mapbuilder/laboratory/odometry_table.h"

namespace floorloc {
namespace {

// The seed depends on the image's index, so that all features get the same manipulations.
CopyOptions CopiesOf(std::size_t image, const FeatureEvaluationOptions& options) {
  CopyOptions copies;
  copies.features = options.features_per_image;
  copies.seed = options.seed * 1000U + static_cast<std::uint32_t>(image);
  return copies;
}

std::vector<SetScore> ScoreSet(const ImageSet& set, const FeatureEvaluationOptions& options) {
  std::vector<cv::Mat> images;
  for (const std::filesystem::path& file : set.files) {
    images.push_back(ReadImage(file));
  }
  ProgressBar progress("features of " + set.name, static_cast<std::int64_t>(images.size() * options.features.size()),
                       options.run.progress);
  std::vector<SetScore> scores;
  for (const DetectorKind kind : options.features) {
    SetScore score{set.name, kind, {}};
    for (std::size_t i = 0; i < images.size(); ++i) {
      score.images.push_back(MeasureImage(images[i], kind, CopiesOf(i, options)));
      progress.Advance();
    }
    scores.push_back(score);
  }
  return scores;
}

void DrawMatches(const cv::Mat& gray, const cv::Mat& copy, const CopyMatches& found,
                 const std::filesystem::path& file) {
  const cv::Scalar green(60, 180, 60);
  const cv::Scalar red(60, 60, 220);
  std::vector<char> right(found.right.begin(), found.right.end());
  std::vector<char> wrong(right);
  std::transform(right.begin(), right.end(), wrong.begin(), [](char is_right) { return is_right == 0 ? 1 : 0; });
  cv::Mat drawing;
  const auto& a = found.image.keypoints;
  const auto& b = found.copy.keypoints;
  cv::drawMatches(gray, a, copy, b, found.matches, drawing, red, red, wrong,
                  cv::DrawMatchesFlags::NOT_DRAW_SINGLE_POINTS);
  cv::drawMatches(gray, a, copy, b, found.matches, drawing, green, green, right,
                  cv::DrawMatchesFlags::NOT_DRAW_SINGLE_POINTS | cv::DrawMatchesFlags::DRAW_OVER_OUTIMG);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", drawing, jpeg);
  WriteFileAtomically(file, std::string(jpeg.begin(), jpeg.end()));
}

// Draws the matches of a set's first image under every condition, right ones green and wrong ones red.
void DrawFirstImage(const ImageSet& set, const std::vector<SetScore>& scores, const FeatureEvaluationOptions& options) {
  const cv::Mat gray = ReadImage(set.files.front());
  const CopyOptions copies = CopiesOf(0, options);
  for (const SetScore& score : scores) {
    for (const Condition condition : kConditions) {
      const CopyMatches found = MatchWithCopy(gray, score.images.front().setting, condition, copies);
      const std::string name = set.name + "-" + ToString(condition) + "-" + ToString(score.kind) + ".jpg";
      DrawMatches(gray, Manipulate(gray, condition, copies.seed), found, options.image_folder / name);
    }
  }
}

std::vector<cv::Mat> ReadSequence(const std::filesystem::path& folder, int following) {
  std::vector<std::filesystem::path> files = ImagesOf(folder);
  if (files.size() < 2) {
    throw InputError(folder, "has fewer than two images; a sequence needs a first one and some that follow");
  }
  files.resize(std::min(files.size(), static_cast<std::size_t>(following) + 1));
  std::vector<cv::Mat> frames;
  for (const std::filesystem::path& file : files) {
    frames.push_back(ReadImage(file));
  }
  return frames;
}

std::vector<FollowingScore> ScoreSequences(const FeatureEvaluationOptions& options) {
  std::vector<std::vector<cv::Mat>> sequences;
  for (const std::filesystem::path& folder : options.sequences) {
    sequences.push_back(ReadSequence(folder, options.following_frames));
  }
  const std::size_t steps = options.features.size() * options.features_of_sequences.size() * sequences.size();
  ProgressBar progress("following frames", static_cast<std::int64_t>(steps), options.run.progress);
  std::vector<FollowingScore> scores;
  for (const DetectorKind kind : options.features) {
    for (const int wanted : options.features_of_sequences) {
      FollowingScore score{kind, wanted, {}};
      for (const std::vector<cv::Mat>& frames : sequences) {
        score.sequences.push_back(MeasureSequence(frames, kind, wanted));
        progress.Advance();
      }
      scores.push_back(score);
    }
  }
  return scores;
}

void AddSetTables(const FeatureEvaluationOptions& options, LaboratoryReport* report) {
  std::vector<SetScore> all;
  std::vector<ResultTable> tables;
  for (const ImageSet& set : options.sets) {
    const std::vector<SetScore> scores = ScoreSet(set, options);
    if (!options.image_folder.empty()) {
      DrawFirstImage(set, scores, options);
    }
    tables.push_back(ConditionTable(tables.empty() ? 2 : 3, scores));
    all.insert(all.end(), scores.begin(), scores.end());
    report->conditions.push_back(set.name + ": " + std::to_string(set.files.size()) + " images");
  }
  report->tables.push_back(TimeTable(all));
  report->tables.insert(report->tables.end(), tables.begin(), tables.end());
}

void AddSequenceTables(const FeatureEvaluationOptions& options, LaboratoryReport* report) {
  if (options.sequences.empty()) {
    report->conditions.push_back("tables 4 and 5 are left out: they need --sequence FOLDER");
    return;
  }
  const std::vector<FollowingScore> scores = ScoreSequences(options);
  report->tables.push_back(FollowingTable(scores));
  report->tables.push_back(CorrelationTable(scores));
}

void AddDriveTable(const FeatureEvaluationOptions& options, LaboratoryReport* report) {
  if (options.drive.empty()) {
    report->conditions.push_back("table 6 is left out: it needs --drive FOLDER");
    return;
  }
  const std::vector<DriveScore> scores = ScoreDrive(options.drive, options.features, options.run.progress);
  report->tables.push_back(DriveTable(scores));
  if (!options.image_folder.empty()) {
    DrawDrive(scores, options.image_folder);
  }
}

}  // namespace

void FeatureEvaluationOptions::Check() const {
  constexpr int kMaxFeatures = 100'000;
  const auto is_count = [](int count) { return count > 0 && count <= kMaxFeatures; };
  if (!is_count(features_per_image) ||
      !std::all_of(features_of_sequences.begin(), features_of_sequences.end(), is_count)) {
    throw std::invalid_argument("the number of features must be from 1 to 100000");
  }
  if (following_frames < 1) {
    throw std::invalid_argument("the number of following frames must be at least 1");
  }
  for (const DetectorKind kind : features) {
    if (kind != DetectorKind::kOrb && kind != DetectorKind::kAkaze && kind != DetectorKind::kBrisk &&
        kind != DetectorKind::kSift && kind != DetectorKind::kSurf) {
      throw std::invalid_argument(std::string(ToString(kind)) +
                                  " does not both detect and describe; take orb, akaze, brisk, sift or surf");
    }
    if (kind == DetectorKind::kSurf && !SurfAvailable()) {
      throw std::invalid_argument("surf was left out of this build; name the others with --features");
    }
  }
}

LaboratoryReport EvaluateFeatures(const FeatureEvaluationOptions& options) {
  options.Check();
  LaboratoryReport report;
  report.title = "Features for visual odometry";
  if (options.sets.empty()) {
    report.conditions.push_back("tables 1 to 3 are left out: they need --images NAME=FOLDER");
  } else {
    AddSetTables(options, &report);
  }
  if (options.sets.size() == 1) {
    report.conditions.push_back("table 3 is left out: it needs a second --images NAME=FOLDER");
  }
  AddSequenceTables(options, &report);
  AddDriveTable(options, &report);
  return report;
}

}  // namespace floorloc
