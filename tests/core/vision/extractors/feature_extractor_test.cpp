// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/feature_extractor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/geometry/pose2.h"
#include "core/vision/matching/descriptor_index.h"
#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::CenteredImage;
using testing_vision::InThreads;
using testing_vision::kResolutionM;
using testing_vision::MakeTexture;
using testing_vision::Same;

const cv::Size kSize(420, 400);

ExtractorOptions OptionsOf(ExtractorType type) {
  ExtractorOptions options;
  options.type = type;
  return options;
}

// A keypoint's match in the rotated image: position and angle error, pixels and radians.
struct TurnedPair {
  Eigen::Vector2d offset_px;  // duplicate minus expectation, base frame's axes
  double angle_rad = 0.0;
};

// Matches features with those of the same image rotated about the base frame's origin.
std::vector<TurnedPair> MatchTurned(const Features& upright, const Features& turned, double turn_rad) {
  const Pose2 turn(0.0, 0.0, turn_rad);
  const auto index = CreateDescriptorIndex(upright.descriptors, {.type = MatcherType::kBruteForce});
  std::vector<TurnedPair> pairs;
  for (const Match& match : FilterByRatio(FindNearest(*index, turned.descriptors), 0.8F)) {
    const Keypoint& from = upright.keypoints[static_cast<std::size_t>(match.train)];
    const Keypoint& to = turned.keypoints[static_cast<std::size_t>(match.query)];
    const Eigen::Vector2d offset_px = (to.Position() - turn * from.Position()) / kResolutionM;
    if (offset_px.norm() < 2.0) {
      pairs.push_back({offset_px, WrapAngle(to.angle_rad - from.angle_rad - turn_rad)});
    }
  }
  return pairs;
}

class Extractor : public ::testing::TestWithParam<ExtractorType> {
 protected:
  std::unique_ptr<FeatureExtractor> extractor_ = CreateFeatureExtractor(OptionsOf(GetParam()));
};

TEST_P(Extractor, FindsKeypointsOnPlainFloor) {
  const Features features = extractor_->Extract(CenteredImage(MakeTexture(kSize, 90.0, 2.0, 1)));
  EXPECT_GE(features.keypoints.size(), 200U);
}

TEST_P(Extractor, FindsKeypointsOnBrightFloor) {
  const Features features = extractor_->Extract(CenteredImage(MakeTexture(kSize, 225.0, 8.0, 2)));
  EXPECT_GE(features.keypoints.size(), 200U);
}

TEST_P(Extractor, FindsNothingWhereThereIsNothing) {
  EXPECT_TRUE(extractor_->Extract(CenteredImage(cv::Mat::zeros(kSize, CV_8UC1))).keypoints.empty());
  EXPECT_TRUE(extractor_->Extract(CenteredImage(cv::Mat(kSize, CV_8UC1, cv::Scalar(255)))).keypoints.empty());
}

TEST_P(Extractor, DescribesEveryKeypoint) {
  const Features features = extractor_->Extract(CenteredImage(MakeTexture(kSize, 100.0, 12.0, 3)));
  EXPECT_LE(features.keypoints.size(), 700U);
  EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.keypoints.size()));
  EXPECT_EQ(features.descriptors.cols, extractor_->descriptor_length());
  EXPECT_EQ(features.descriptors.type(), extractor_->descriptor_type() == DescriptorType::kBinary ? CV_8U : CV_32F);
  for (const Keypoint& k : features.keypoints) {
    EXPECT_GT(k.size_m, 1.5 * kResolutionM);
    EXPECT_LE(std::abs(k.x_m), 0.5 * kSize.height * kResolutionM);
    EXPECT_LE(std::abs(k.y_m), 0.5 * kSize.width * kResolutionM);
  }
}

// A systematic offset of the keypoints appears twice when the image is rotated by 180 degrees. Image sides that the
// pyramid does not divide evenly are critical: rounded level sizes scale the coordinates.
TEST_P(Extractor, KeypointsHaveNoSystematicOffset) {
  for (const cv::Size size : {cv::Size(420, 400), cv::Size(421, 401), cv::Size(593, 443)}) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0.0;
    for (std::uint64_t seed = 10; seed < 12; ++seed) {
      const cv::Mat upright = MakeTexture(size, 110.0, 14.0, seed);
      cv::Mat turned;
      cv::rotate(upright, turned, cv::ROTATE_180);
      for (const TurnedPair& pair : MatchTurned(extractor_->Extract(CenteredImage(upright)),
                                                extractor_->Extract(CenteredImage(turned)), std::numbers::pi)) {
        sum += 0.5 * pair.offset_px;
        ++count;
      }
    }
    ASSERT_GT(count, 300.0);
    EXPECT_LT(std::abs(sum.x() / count), 0.06) << size << " mean " << (sum / count).transpose();
    EXPECT_LT(std::abs(sum.y() / count), 0.06) << size << " mean " << (sum / count).transpose();
  }
}

TEST_P(Extractor, KeypointsTurnWithTheImage) {
  const cv::Mat upright = MakeTexture(kSize, 110.0, 14.0, 20);
  const Features features = extractor_->Extract(CenteredImage(upright));
  cv::Mat turned;
  cv::rotate(upright, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const auto pairs = MatchTurned(features, extractor_->Extract(CenteredImage(turned)), 0.5 * std::numbers::pi);
  ASSERT_GT(pairs.size(), features.keypoints.size() / 2);
  int close = 0;
  for (const TurnedPair& pair : pairs) {
    close += std::abs(pair.angle_rad) < 0.17 ? 1 : 0;
  }
  EXPECT_GT(close, 0.7 * static_cast<double>(pairs.size()));  // BRISK's angle is the least repeatable
}

TEST_P(Extractor, SameImageSameFeatures) {
  const GroundImage image = CenteredImage(MakeTexture(kSize, 110.0, 14.0, 30));
  const Features once = extractor_->Extract(image);
  EXPECT_TRUE(Same(extractor_->Extract(image), once));
  EXPECT_TRUE(Same(CreateFeatureExtractor(OptionsOf(GetParam()))->Extract(image), once));
}

TEST_P(Extractor, EveryThreadGetsTheSameFeatures) {
  std::vector<GroundImage> images;
  std::vector<Features> alone;
  for (std::uint64_t i = 0; i < 8; ++i) {
    images.push_back(CenteredImage(MakeTexture({200, 180}, 110.0, 14.0, 40 + i)));
    alone.push_back(extractor_->Extract(images.back()));
  }
  std::vector<Features> together(8);
  InThreads(8, [&](std::size_t i) { together[i] = extractor_->Extract(images[i]); });
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_TRUE(Same(together[i], alone[i])) << i;
  }
}

TEST_P(Extractor, NoDescriptorReachesIntoMaskedFloor) {
  GroundImage image = CenteredImage(MakeTexture(kSize, 110.0, 14.0, 50));
  const cv::Rect unseen(0, 0, 120, kSize.height);
  image.mask(unseen) = 0;
  image.gray(unseen) = 0;
  const Features features = extractor_->Extract(image);
  EXPECT_GT(features.keypoints.size(), 100U);
  for (const Keypoint& k : features.keypoints) {
    EXPECT_GT(image.grid.PixelFromBase(k.Position()).x(), 120.0 + 3.0);
  }
}

TEST_P(Extractor, ToleratesTinyImages) {
  ExtractorOptions deep = OptionsOf(GetParam());
  deep.levels = 8;
  const auto deep_extractor = CreateFeatureExtractor(deep);
  for (const int side : {1, 2, 8, 13, 16, 20, 31, 40, 79, 80, 100}) {
    const GroundImage image = CenteredImage(MakeTexture({side, side + 3}, 110.0, 14.0, 60));
    EXPECT_NO_THROW(extractor_->Extract(image)) << side;
    EXPECT_NO_THROW(deep_extractor->Extract(image)) << side;
  }
}

INSTANTIATE_TEST_SUITE_P(AllTypes, Extractor, ::testing::ValuesIn(AllExtractorTypes()),
                         [](const auto& name) { return std::string(ToString(name.param)); });

TEST(ExtractorOptionsTest, NamesReadBack) {
  for (const ExtractorType type : AllExtractorTypes()) {
    EXPECT_EQ(ParseExtractorType(ToString(type)), type);
  }
  EXPECT_THROW(ParseExtractorType("surff"), std::invalid_argument);
}

TEST(ExtractorOptionsTest, RefusesNonsense) {
  const auto with = [](auto member, auto value) {
    ExtractorOptions options;
    options.*member = value;
    return options;
  };
  EXPECT_NO_THROW(ExtractorOptions().Check());
  EXPECT_THROW(with(&ExtractorOptions::max_keypoints, 0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::cell_px, 0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::levels, 0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::scale_factor, 1.0).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::threshold, std::nan("")).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::normalize_radius_px, -1).Check(), std::invalid_argument);
  EXPECT_THROW(with(&ExtractorOptions::smooth_sigma_px, -0.1).Check(), std::invalid_argument);
  EXPECT_THROW(CreateFeatureExtractor(with(&ExtractorOptions::levels, 99)), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
