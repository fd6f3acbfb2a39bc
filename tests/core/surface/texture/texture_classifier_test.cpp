// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/texture_classifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/surface/texture/saturating_counter.h"
#include "core/surface/texture/texture_model_file.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

// Claims what is brighter (sign 1) or darker (-1) than its variance times a factor.
StrongClassifier Claims(const TextureFeatures& weights, double error, double alpha = 1.0) {
  return {{{weights, 1, alpha}}, error};
}

// Dark blocks are shadow; else contrast decides.
TextureClassifier Model() {
  TextureClassifier model;
  model.classes[0] = Claims({-1.0, 1.0, 0.0, 0.0}, 0.2);   // variance above the mean
  model.classes[1] = Claims({1.0, -1.0, 0.0, 0.0}, 0.1);   // below it
  model.classes[2] = Claims({-1.0, 0.0, 40.0, 0.0}, 0.0);  // mean below 40 times the energy
  return model;
}

cv::Mat Textured(double mean, double sigma) {
  cv::Mat gray(240, 320, CV_8UC1);
  cv::RNG(9).fill(gray, cv::RNG::NORMAL, mean, sigma);
  return gray;
}

TEST(TextureClassifierTest, TheSurestOfThoseThatClaimABlockWins) {
  const TextureClassifier model = Model();
  EXPECT_EQ(model.Classify({100.0, 400.0, 0.01, 0.0}), TextureClass::kRough);
  EXPECT_EQ(model.Classify({100.0, 20.0, 0.05, 0.0}), TextureClass::kSmooth);
  // Claimed as smooth and as shadow: shadow has the smaller error.
  EXPECT_EQ(model.Classify({10.0, 2.0, 0.5, 0.0}), TextureClass::kShadow);
}

TEST(TextureClassifierTest, WhatNoneClaimsIsUnknown) {
  TextureClassifier model = Model();
  model.classes[0].reset();
  EXPECT_EQ(model.Classify({100.0, 400.0, 0.01, 0.0}), TextureClass::kUnknown);
}

TEST(TextureAssessmentTest, BlocksVoteAndShadowDoesNot) {
  cv::Mat gray = Textured(120.0, 3.0);      // smooth
  gray(cv::Rect(0, 0, 320, 160)).setTo(4);  // two of three rows in shadow
  const TextureAssessment assessment = AssessTexture(gray, Model());
  EXPECT_EQ(assessment.texture, TextureClass::kSmooth);
  const cv::Mat mask = assessment.WithoutShadow(gray.size());
  EXPECT_EQ(cv::countNonZero(mask), 320 * 80);
  EXPECT_EQ(mask.at<std::uint8_t>(200, 10), 255);
}

TEST(TextureAssessmentTest, AsManyRoughAsSmoothBlocksDecideNothing) {
  cv::Mat gray = Textured(120.0, 3.0);
  cv::RNG(2).fill(gray(cv::Rect(0, 0, 160, 240)), cv::RNG::NORMAL, 120.0, 40.0);
  EXPECT_EQ(AssessTexture(gray, Model()).texture, TextureClass::kUnknown);
}

TEST(SaturatingCounterTest, TwoBitsNeedTwoImagesToChange) {
  SaturatingCounter counter(2);
  EXPECT_FALSE(counter.ChoosesFast());
  for (int i = 0; i < 5; ++i) {
    counter.Add(TextureClass::kRough);
  }
  EXPECT_EQ(counter.state(), 3);
  counter.Add(TextureClass::kSmooth);
  EXPECT_TRUE(counter.ChoosesFast());
  counter.Add(TextureClass::kUnknown);
  counter.Add(TextureClass::kShadow);
  EXPECT_EQ(counter.state(), 2);
  counter.Add(TextureClass::kSmooth);
  EXPECT_FALSE(counter.ChoosesFast());
  for (int i = 0; i < 5; ++i) {
    counter.Add(TextureClass::kSmooth);
  }
  EXPECT_EQ(counter.state(), 0);
}

TEST(SaturatingCounterTest, OneBitFollowsEachImage) {
  SaturatingCounter counter(1);
  counter.Add(TextureClass::kRough);
  EXPECT_TRUE(counter.ChoosesFast());
  counter.Add(TextureClass::kSmooth);
  EXPECT_FALSE(counter.ChoosesFast());
  EXPECT_THROW(SaturatingCounter(0), std::invalid_argument);
}

TEST(TextureModelFile, IsReadBackExactly) {
  TextureClassifier model = Model();
  model.grid.skipped_rows = 1;
  model.classes[2]->weak.push_back({TextureFeatures(1.0 / 3.0, -2e-17, 5e10, 0.0), -1, 0.1});
  const std::string text = FormatTextureModel(model);
  const TextureClassifier read = ParseTextureModel(text);
  EXPECT_EQ(FormatTextureModel(read), text);
  EXPECT_EQ(read.grid.skipped_rows, 1);
  EXPECT_EQ(read.classes[2]->weak.at(1).weights, model.classes[2]->weak.at(1).weights);
}

std::string ErrorOf(const std::string& text) {
  try {
    ParseTextureModel(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TextureModelFile, WhatIsNoModelIsRefusedWithItsLine) {
  const std::string good = FormatTextureModel(Model());
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(ErrorOf(good), "");
  EXPECT_THAT(ErrorOf(""), HasSubstr("no texture model"));
  EXPECT_THAT(ErrorOf(replaced("texture 1", "texture 2")), HasSubstr("train the model again"));
  EXPECT_THAT(ErrorOf(replaced("grid 4 3 0", "grid 4 3 3")), HasSubstr("line 2"));
  EXPECT_THAT(ErrorOf(replaced("class SMOOTH", "class ROUGH")), HasSubstr("twice"));
  EXPECT_THAT(ErrorOf(replaced("class SHADOW", "class SAND")), HasSubstr("none of ROUGH"));
  EXPECT_THAT(ErrorOf(replaced("classifiers 1", "classifiers 7")), HasSubstr("line"));
  EXPECT_THAT(ErrorOf(replaced("error 0", "error nan")), HasSubstr("finite"));
  EXPECT_THAT(ErrorOf(good.substr(0, good.find("class SMOOTH"))), HasSubstr("needs the classes"));
  EXPECT_THAT(ErrorOf(good.substr(0, good.size() - 10)), HasSubstr("line"));
}

}  // namespace
}  // namespace floorloc
