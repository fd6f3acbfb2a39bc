// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/unpack/survey_plan.h"

namespace floorloc {

/// Command line arguments of commands that read bags in the place of survey folders.
struct BagArguments {
  std::vector<std::filesystem::path> bags;
  SurveyChoice choice;
};

/// --image-topic and the others; `needed` is the option of the bag, or nullptr.
void AddTopicOptions(CLI::App* command, CLI::Option* needed, SurveyChoice* choice);
/// --camera and --floor, of commands that do not have them for other reasons.
void AddCalibrationOptions(CLI::App* command, CLI::Option* needed, SurveyChoice* choice);

/// Unpacks bags to survey folders beside an output, in OUTPUT.bag/NAME. One that is there already and is of the same
/// bag and options is used again.
class BagInput {
 public:
  enum class Lifetime {
    kTemporary,      ///< removed by the destructor
    kUntilFinished,  ///< removed by Finish(): a failed build, whose journal refers to them, is resumed
  };
  /// Throws InputError, with what a bag lacks and what to do.
  BagInput(const BagArguments& arguments, const std::filesystem::path& output, const ProgressOutput& progress,
           Lifetime lifetime);
  ~BagInput();
  BagInput(const BagInput&) = delete;
  BagInput& operator=(const BagInput&) = delete;

  const std::vector<std::filesystem::path>& folders() const { return folders_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// What was chosen, and why.
  const std::vector<std::string>& notes() const { return notes_; }
  void Finish() const;

 private:
  std::filesystem::path Unpack(const std::filesystem::path& bag);

  BagArguments arguments_;
  std::filesystem::path root_;
  ProgressOutput progress_;
  Lifetime lifetime_;
  std::vector<std::filesystem::path> folders_;
  std::vector<std::string> warnings_;
  std::vector<std::string> notes_;
};

/// --frames or --bag, of which a command reads one, and the options of bags.
void AddDriveOptions(CLI::App* command, std::filesystem::path* frames, BagArguments* bag);
/// What such a command reads: `frames`, or the unpacked bag.
std::filesystem::path FolderOf(const std::filesystem::path& frames, const BagInput& bag);
/// To stderr.
void PrintWarnings(const BagInput& bag);

}  // namespace floorloc
