// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/texture_model_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace floorloc {
namespace {

constexpr const char* kTitle = "floorloc-texture";
constexpr int kVersion = 1;
constexpr int kMaxClassifiers = 1000;

std::string Exact(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", number);
  return text;
}

// Lines of words, with the number of the current one for messages.
class ModelReader {
 public:
  explicit ModelReader(const std::string& text) : text_(text) {}

  // False at the end.
  bool NextLine() {
    std::string line;
    if (!std::getline(text_, line)) {
      return false;
    }
    ++number_;
    words_ = std::istringstream(line);
    return true;
  }
  std::string Word() {
    std::string word;
    words_ >> word;
    return word;
  }
  void Expect(const std::string& word) {
    if (Word() != word) {
      Refuse("'" + word + "' is missing");
    }
  }
  int Integer(int low, int high) {
    const double number = Real();
    if (number != std::floor(number) || number < low || number > high) {
      Refuse("a number is not a whole one from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return static_cast<int>(number);
  }
  double Real() {
    double number = 0.0;
    if (!(words_ >> number) || !std::isfinite(number)) {
      Refuse("a finite number is missing");
    }
    return number;
  }
  void EndLine() {
    if (!Word().empty()) {
      Refuse("there is more than expected");
    }
  }
  [[noreturn]] void Refuse(const std::string& why) const {
    throw std::invalid_argument("line " + std::to_string(number_) + ": " + why);
  }

 private:
  std::istringstream text_;
  std::istringstream words_;
  int number_ = 0;
};

WeakClassifier ReadWeak(ModelReader* reader) {
  if (!reader->NextLine()) {
    reader->Refuse("the model ends before its last classifier");
  }
  WeakClassifier weak;
  for (double& weight : weak.weights) {
    weight = reader->Real();
  }
  weak.sign = reader->Integer(-1, 1);
  weak.alpha = reader->Real();
  if (weak.sign == 0 || weak.alpha <= 0.0) {
    reader->Refuse("a sign is not 1 or -1, or a reliability not positive");
  }
  reader->EndLine();
  return weak;
}

void ReadClass(ModelReader* reader, TextureClassifier* model) {
  reader->Expect("class");
  const std::string name = reader->Word();
  const auto* found = std::find_if(kTextureClasses.begin(), kTextureClasses.end(),
                                   [&](TextureClass texture) { return name == ToString(texture); });
  if (found == kTextureClasses.end()) {
    reader->Refuse("'" + name + "' is none of ROUGH, SMOOTH, SHADOW");
  }
  auto& strong = model->classes[static_cast<std::size_t>(found - kTextureClasses.begin())];
  if (strong) {
    reader->Refuse("class " + name + " stands there twice");
  }
  strong.emplace();
  reader->Expect("error");
  strong->error = reader->Real();
  if (strong->error < 0.0 || strong->error > 1.0) {
    reader->Refuse("an error is not from 0 to 1");
  }
  reader->Expect("classifiers");
  const int count = reader->Integer(1, kMaxClassifiers);
  reader->EndLine();
  for (int i = 0; i < count; ++i) {
    strong->weak.push_back(ReadWeak(reader));
  }
}

}  // namespace

std::string FormatTextureModel(const TextureClassifier& classifier) {
  std::string text = std::string(kTitle) + " " + std::to_string(kVersion) + "\n";
  text += "grid " + std::to_string(classifier.grid.columns) + " " + std::to_string(classifier.grid.rows) + " " +
          std::to_string(classifier.grid.skipped_rows) + "\n";
  for (std::size_t i = 0; i < classifier.classes.size(); ++i) {
    if (!classifier.classes[i]) {
      continue;
    }
    const StrongClassifier& strong = *classifier.classes[i];
    text += std::string("class ") + ToString(kTextureClasses[i]) + " error " + Exact(strong.error) + " classifiers " +
            std::to_string(strong.weak.size()) + "\n";
    for (const WeakClassifier& weak : strong.weak) {
      for (const double weight : weak.weights) {
        text += Exact(weight) + " ";
      }
      text += std::to_string(weak.sign) + " " + Exact(weak.alpha) + "\n";
    }
  }
  return text;
}

TextureClassifier ParseTextureModel(const std::string& text) {
  ModelReader reader(text);
  if (!reader.NextLine() || reader.Word() != kTitle) {
    reader.Refuse("this is no texture model; train one with train-surface --texture");
  }
  if (const std::string version = reader.Word(); version != std::to_string(kVersion)) {
    reader.Refuse("version '" + version + "' is not the one that this program reads, " + std::to_string(kVersion) +
                  "; train the model again");
  }
  TextureClassifier model;
  if (!reader.NextLine()) {
    reader.Refuse("the grid is missing");
  }
  reader.Expect("grid");
  model.grid.columns = reader.Integer(1, 64);
  model.grid.rows = reader.Integer(1, 64);
  model.grid.skipped_rows = reader.Integer(0, model.grid.rows - 1);
  reader.EndLine();
  while (reader.NextLine()) {
    ReadClass(&reader, &model);
  }
  if (!model.classes[0] || !model.classes[1]) {
    reader.Refuse("a model needs the classes ROUGH and SMOOTH");
  }
  return model;
}

}  // namespace floorloc
