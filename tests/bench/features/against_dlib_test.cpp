// SPDX-License-Identifier: Apache-2.0
// Our SURF is at least as repeatable as dlib's with the same scales and number of keypoints.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "tests/bench/features/feature_method.h"
#include "tests/bench/features/feature_score.h"
#include "tests/bench/features/image_change.h"

namespace floorloc {
namespace {

std::vector<cv::Mat> Images() {
  std::vector<cv::Mat> images;
  for (const char* name : {"textures/warehouse_concrete.png", "sample/survey/images/000000.jpg"}) {
    const cv::Mat image = cv::imread(std::string(FLOORLOC_MAPS_DIR "/") + name, cv::IMREAD_GRAYSCALE);
    EXPECT_FALSE(image.empty()) << name;
    images.push_back(image(cv::Rect(0, 0, 640, 480)).clone());
  }
  return images;
}

const FeatureMethod& MethodNamed(const std::vector<FeatureMethod>& methods, const std::string& name) {
  return *std::find_if(methods.begin(), methods.end(), [&](const FeatureMethod& m) { return m.name == name; });
}

class AgainstDlib : public ::testing::TestWithParam<ImageChange> {};

TEST_P(AgainstDlib, AtLeastAsSteady) {
  const std::vector<FeatureMethod> methods = ComparedMethods(800);
  FeatureScore ours;
  FeatureScore dlibs;
  for (const cv::Mat& before : Images()) {
    const cv::Mat after = Apply(GetParam(), before);
    const auto score = [&](const std::string& name) {
      const FeatureMethod& method = MethodNamed(methods, name);
      return ScoreFeatures(method.extract(before), method.extract(after), GetParam().motion(before.size()),
                           before.size());
    };
    ours.Add(score("surf as dlib"));
    dlibs.Add(score("dlib surf"));
  }
  EXPECT_GE(ours.repeatability(), dlibs.repeatability());
  EXPECT_GE(ours.matching_score(), dlibs.matching_score());
  EXPECT_GT(ours.matched, 100);
  EXPECT_LT(cv::norm(ours.offset) / ours.matched, 0.1);  // px, systematic
}

INSTANTIATE_TEST_SUITE_P(Changes, AgainstDlib, ::testing::ValuesIn(ImageChanges()), [](const auto& change) {
  std::string name = change.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '.'; }, '_');
  return name;
});

}  // namespace
}  // namespace floorloc
