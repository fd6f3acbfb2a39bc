// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/surface/classes/model_file.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/cli/train_texture.h"
#include "mapbuilder/surface/class_training.h"

namespace floorloc {
namespace {

// Raw command line arguments.
struct Arguments {
  std::filesystem::path classes;
  std::filesystem::path out;
  std::vector<std::string> groups;
  bool json = false;
  ClassTrainingOptions options;
  TextureArguments texture;
};

// Names of groups, or of sets of them.
std::vector<FeatureGroup> ParseGroups(const std::vector<std::string>& names) {
  std::vector<FeatureGroup> groups;
  const auto add = [&](FeatureGroup group) {
    if (std::find(groups.begin(), groups.end(), group) == groups.end()) {
      groups.push_back(group);
    }
  };
  for (const std::string& name : names) {
    if (name == "paper") {
      for (const FeatureGroup group : PaperGroups()) {
        add(group);
      }
    } else if (name == "texture") {
      add(FeatureGroup::kPattern);
      add(FeatureGroup::kGradient);
    } else if (const std::optional<FeatureGroup> group = ParseGroup(name)) {
      add(*group);
    } else {
      throw std::invalid_argument("'" + name + "' is no group of features");
    }
  }
  return groups;
}

std::string CheckGroup(const std::string& name) {
  try {
    ParseGroups({name});
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

std::string NameOf(const std::vector<FeatureGroup>& groups) {
  std::string name;
  for (const FeatureGroup group : groups) {
    name += (name.empty() ? "" : "+") + std::string(GroupName(group));
  }
  return name;
}

nlohmann::ordered_json ToJson(const TrainedClasses& trained) {
  const ClassTrainingReport& report = trained.report;
  nlohmann::ordered_json json{{"classes", trained.model.classes},
                              {"pictures", report.pictures},
                              {"samples", report.samples},
                              {"c", report.parameters.c},
                              {"gamma", report.parameters.gamma},
                              {"held_out_right", report.held_out.RightShare()},
                              {"held_out_mean_score", report.mean_score}};
  for (int r = 0; r < report.held_out.classes(); ++r) {
    nlohmann::ordered_json row = nlohmann::json::array();
    for (int c = 0; c < report.held_out.classes(); ++c) {
      row.push_back(report.held_out.Count(r, c));
    }
    json["confusion"].push_back(row);
  }
  for (std::size_t i = 0; i < report.inputs.size(); ++i) {
    json["inputs"].push_back({{"groups", NameOf(report.inputs[i])}, {"rounds", report.rounds[i]}});
  }
  return json;
}

std::string ToText(const TrainedClasses& trained) {
  const ClassTrainingReport& report = trained.report;
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  text << report.pictures << " pictures of " << trained.model.classes.size() << " classes, " << report.samples
       << " segments\nHeld out with all that look like them, " << 100.0 * report.held_out.RightShare()
       << " % of the pictures are right; their mean score is " << 100.0 * report.mean_score << " %.\n\n";
  constexpr int kWidth = 16;
  text << std::left << std::setw(kWidth) << "marked as" << std::right;
  for (const std::string& name : trained.model.classes) {
    text << std::setw(kWidth) << name;
  }
  text << "\n";
  for (int r = 0; r < report.held_out.classes(); ++r) {
    text << std::left << std::setw(kWidth) << trained.model.classes[static_cast<std::size_t>(r)] << std::right;
    for (int c = 0; c < report.held_out.classes(); ++c) {
      text << std::setw(kWidth - 2) << 100.0 * report.held_out.Share(r, c) << " %";
    }
    text << "\n";
  }
  text << "\nC " << report.parameters.c << ", gamma " << report.parameters.gamma
       << " / numbers of the input; rounds of boosting that each input won:";
  for (std::size_t i = 0; i < report.inputs.size(); ++i) {
    text << (i == 0 ? " " : ", ") << NameOf(report.inputs[i]) << " " << report.rounds[i];
  }
  text << "\n";
  return text.str();
}

void TrainClassModel(const Arguments& a) {
  ClassTrainingOptions options = a.options;
  if (!a.groups.empty()) {
    options.groups = ParseGroups(a.groups);
  }
  options.boosting.seed = options.seed;
  options.run.progress = ProgressOutput::Stderr();
  const LabelledFolder folder = ListClasses(a.classes);
  CheckWritable(a.out);
  const TrainedClasses trained = TrainClasses(folder, options);
  WriteFileAtomically(a.out, FormatSurfaceModel(trained.model));
  std::cout << (a.json ? ToJson(trained).dump(2) + "\n" : ToText(trained));
}

void Run(const Arguments& a) {
  if (!a.classes.empty()) {
    TrainClassModel(a);
    return;
  }
  TextureArguments texture = a.texture;
  texture.out = a.out;
  texture.json = a.json;
  texture.samples.seed = texture.training.seed = static_cast<std::uint32_t>(a.options.seed);
  TrainTextureModel(texture);
}

// What is learnt: exactly one of them.
CLI::Option* AddSources(CLI::App* command, Arguments* a) {
  CLI::Option_group* sources = command->add_option_group("What to learn");
  CLI::Option* classes = sources->add_option(
      "--classes", a->classes,
      "Classes of floors: folder with a folder of pictures per class; depth/ and intensity/ in each "
      "of them if there is a range sensor");
  AddTextureOptions(command, sources, &a->texture);
  sources->require_option(1);
  return classes;
}

}  // namespace

void AddTrainSurfaceCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "train-surface", "Learns classes of floors, or rough from smooth floor, from pictures: a model for 'classify'");
  const auto a = std::make_shared<Arguments>();
  ClassTrainingOptions& o = a->options;
  CLI::Option* classes = AddSources(command, a.get());
  command->add_option("--out", a->out, "The model to write")->required();
  command
      ->add_option("--groups", a->groups,
                   "Features: paper (hue-saturation, value, color, depth-intensity, intensity), texture (pattern, "
                   "gradient), shape, or single ones. Default: paper,texture")
      ->needs(classes)
      ->delimiter(',')
      ->check(CheckGroup);
  command->add_option("--rounds", o.boosting.rounds, "Of boosting")
      ->needs(classes)
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->add_option("--folds", o.folds.folds, "Of the cross-validation")
      ->needs(classes)
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  command->add_flag("--json", a->json, "Print JSON");
  command->add_option("--seed", o.seed, "Of the draws of segments, or of the images kept for testing")
      ->capture_default_str();
  command->add_option("--threads", o.run.threads, "Number of threads; 0: one per core")->capture_default_str();
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
