// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/extractors/chosen_extractor.h"

#include <algorithm>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <ostream>

#include "core/vision/image/rectifier.h"

namespace floorloc {
namespace {

constexpr int kWidthPx = 320;

TextureClass Assess(const GroundImage& image, const TextureClassifier& classifier) {
  cv::Mat gray = image.gray;
  if (gray.cols > kWidthPx) {
    cv::resize(gray, gray, {kWidthPx, gray.rows * kWidthPx / gray.cols}, 0.0, 0.0, cv::INTER_AREA);
  }
  return AssessTexture(gray, classifier).texture;
}

// Of the frames of a group.
struct Choice {
  std::string name;
  std::vector<bool> found;
  std::vector<double> search_ms;
};

void PrintChoice(std::ostream& out, const Choice& choice, const std::vector<TextureClass>& textures) {
  const auto found_of = [&](TextureClass texture) {
    int found = 0;
    for (std::size_t i = 0; i < textures.size(); ++i) {
      found += textures[i] == texture && choice.found[i] ? 1 : 0;
    }
    return found;
  };
  out << std::left << std::setw(40) << choice.name << std::right << std::setw(7)
      << std::count(choice.found.begin(), choice.found.end(), true) << std::setw(8) << found_of(TextureClass::kRough)
      << std::setw(8) << found_of(TextureClass::kSmooth) << std::setw(9) << std::fixed << std::setprecision(1)
      << Mean(choice.search_ms) << "\n";
}

Choice Alone(const ExtractorTally& tally, const std::string& group) {
  const GroupTally& frames = tally.groups.at(group);
  return {tally.name, frames.global.found, frames.search_ms};
}

Choice ByTexture(const Choice& rough, const Choice& smooth, const std::vector<TextureClass>& textures) {
  Choice choice{rough.name + " on ROUGH, else " + smooth.name, {}, {}};
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const Choice& chosen = textures[i] == TextureClass::kRough ? rough : smooth;
    choice.found.push_back(chosen.found[i]);
    choice.search_ms.push_back(chosen.search_ms[i]);
  }
  return choice;
}

// Searches with the second where the first finds nothing.
Choice OneAfterTheOther(const Choice& first, const Choice& second) {
  Choice choice{first.name + ", in vain: " + second.name, {}, {}};
  for (std::size_t i = 0; i < first.found.size(); ++i) {
    choice.found.push_back(first.found[i] || second.found[i]);
    choice.search_ms.push_back(first.search_ms[i] + (first.found[i] ? 0.0 : second.search_ms[i]));
  }
  return choice;
}

}  // namespace

void AssessFrames(const Scene& scene, const TextureClassifier& classifier, TexturesByGroup* textures) {
  for (const FrameGroup& group : scene.groups) {
    const Rectifier rectifier(group.camera);
    for (const SceneFrame& frame : group.frames) {
      (*textures)[group.name].push_back(Assess(rectifier.Rectify(frame.raw), classifier));
    }
  }
}

void PrintChoices(std::ostream& out, const std::vector<ExtractorTally>& tallies, const TexturesByGroup& textures) {
  out << "\nChosen by each frame's texture. ms: mean of the thread's time from the raw image to the answer of the "
         "whole "
         "map.\n";
  for (const auto& [group, classes] : textures) {
    out << "-- " << group << ": " << classes.size() << " frames, "
        << std::count(classes.begin(), classes.end(), TextureClass::kRough) << " ROUGH, "
        << std::count(classes.begin(), classes.end(), TextureClass::kSmooth) << " SMOOTH\n"
        << std::left << std::setw(40) << "extractor" << std::right << std::setw(7) << "found" << std::setw(8) << "ROUGH"
        << std::setw(8) << "SMOOTH" << std::setw(9) << "ms\n";
    std::vector<Choice> alone;
    for (const ExtractorTally& tally : tallies) {
      alone.push_back(Alone(tally, group));
      PrintChoice(out, alone.back(), classes);
    }
    for (const Choice& fast : alone) {
      for (const Choice& slow : alone) {
        if (Mean(fast.search_ms) < Mean(slow.search_ms)) {
          PrintChoice(out, ByTexture(fast, slow, classes), classes);
          PrintChoice(out, OneAfterTheOther(fast, slow), classes);
        }
      }
    }
  }
}

}  // namespace floorloc
