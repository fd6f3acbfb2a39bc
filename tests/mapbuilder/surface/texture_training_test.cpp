// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/texture_training.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <numeric>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/surface/texture/texture_model_file.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Rough blocks have contrast, smooth ones little, shadow is dark.
LabelledTextures Blocks(int count, std::uint64_t seed) {
  cv::RNG random(seed);
  LabelledTextures blocks;
  for (int i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      cv::Mat block(60, 80, CV_8UC1);
      const double mean = k == 2 ? random.uniform(10.0, 40.0) : random.uniform(80.0, 180.0);
      const double sigma = k == 0 ? random.uniform(14.0, 40.0) : random.uniform(2.0, 8.0);
      random.fill(block, cv::RNG::NORMAL, mean, sigma);
      blocks[k].push_back(MeasureTexture(block));
    }
  }
  return blocks;
}

TextureTrainingOptions AtMost(int classifiers) {
  TextureTrainingOptions options;
  options.max_classifiers = classifiers;
  return options;
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TextureTrainingTest, ClassesThatDifferAreToldApart) {
  const TextureTraining training = TrainTextures({Blocks(42, 4), Blocks(18, 5)}, AtMost(20));
  EXPECT_GT(training.accuracy, 0.9);
  ASSERT_EQ(training.classes.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const TextureClassReport& report = training.classes[i];
    EXPECT_EQ(report.training, 42);
    EXPECT_EQ(report.testing, 18);
    EXPECT_EQ(std::accumulate(training.confusion[i].begin(), training.confusion[i].end(), 0), 18);
    EXPECT_EQ(static_cast<int>(training.classifier.classes[i]->weak.size()), report.classifiers);
    EXPECT_EQ(training.classifier.classes[i]->error, report.test_error);
    EXPECT_LE(report.test_error, report.test_curve.front());
  }
  EXPECT_THAT(FormatTraining(training), HasSubstr("SHADOW"));
}

TEST(TextureTrainingTest, ShadowMayBeAbsentAndTheOthersMayNot) {
  TextureSamples samples{Blocks(14, 4), Blocks(6, 5)};
  samples.training[2].clear();
  samples.testing[2].clear();
  const TextureTraining training = TrainTextures(samples, AtMost(5));
  EXPECT_EQ(training.classes.size(), 2U);
  EXPECT_FALSE(training.classifier.classes[2]);
  samples.testing[1].clear();
  EXPECT_THROW(TrainTextures(samples), std::invalid_argument);
}

TEST(TextureTrainingTest, ClassesThatAreAlikeAreRefused) {
  const std::vector<TextureFeatures> alike(6, TextureFeatures(90.0, 4.0, 0.1, 0.0));
  const LabelledTextures blocks{alike, alike, {}};
  EXPECT_THAT(ErrorOf([&] { TrainTextures({blocks, blocks}); }), HasSubstr("look like those of the others"));
}

TEST(TextureTrainingTest, ModelsAreReadBackAndOthersRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "model";
  const TextureTraining training = TrainTextures({Blocks(14, 4), Blocks(6, 5)}, AtMost(5));
  const std::string text = FormatTextureModel(training.classifier);
  WriteFileAtomically(file, text);
  EXPECT_TRUE(IsTextureModel(file));
  EXPECT_EQ(FormatTextureModel(ReadTextureModel(file)), text);
  WriteFileAtomically(file, "floorloc-texture 2\n");
  EXPECT_THAT(ErrorOf([&] { ReadTextureModel(file); }),
              AllOf(HasSubstr(file.string()), HasSubstr("train the model again")));
  WriteFileAtomically(file, "FLOORSRF");
  EXPECT_FALSE(IsTextureModel(file));
}

}  // namespace
}  // namespace floorloc
