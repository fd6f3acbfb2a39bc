// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/floor_recognizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

GroundImage View(const cv::Mat& gray) {
  cv::Mat bytes;
  gray.convertTo(bytes, CV_8UC1);
  return {{}, bytes, cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255))};
}

// A floor of random spots of all sizes, as real ones have: the deviation grows with the size by this factor per octave.
// CV_32FC1 around 120.
cv::Mat Floor(double growth, double contrast, std::uint64_t seed = 1) {
  cv::Mat floor(432, 576, CV_32FC1, cv::Scalar(0.0));
  cv::RNG random(seed);
  double weight = 1.0;
  for (double sigma_px = 0.7; sigma_px < 20.0; sigma_px *= 2.0) {
    cv::Mat spots(floor.size(), CV_32FC1);
    random.fill(spots, cv::RNG::NORMAL, 0.0, 1.0);
    cv::GaussianBlur(spots, spots, {}, sigma_px);
    cv::Scalar mean, deviation;
    cv::meanStdDev(spots, mean, deviation);
    floor += weight / deviation[0] * spots;
    weight *= growth;
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(floor, mean, deviation);
  return 120.0 + contrast / deviation[0] * floor;
}

cv::Mat WithNoise(const cv::Mat& image, double sigma) {
  cv::Mat noise(image.size(), CV_32FC1);
  cv::RNG(77).fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  return image + noise;
}

FloorTextureModel Learn(double growth, double contrast) {
  std::vector<BlockTexture> blocks;
  for (std::uint64_t seed = 10; seed < 13; ++seed) {
    for (const FloorBlock& block : MeasureFloorBlocks(View(WithNoise(Floor(growth, contrast, seed), 1.0)))) {
      blocks.push_back(block.texture);
    }
  }
  return LearnFloorTexture(blocks).value();
}

class FloorRecognizerTest : public ::testing::Test {
 protected:
  FloorTextureModel model_ = Learn(1.0, 8.0);
  FloorRecognizer recognizer_{{model_}};
};

TEST_F(FloorRecognizerTest, TheFloorIsKnownInOtherLight) {
  const cv::Mat floor = Floor(1.0, 8.0);
  for (const double gain : {0.3, 1.0, 1.5}) {
    const FloorVerdict view = recognizer_.Look(View(WithNoise(gain * floor, 1.5)));
    EXPECT_FALSE(view.strange) << gain;
    EXPECT_EQ(view.blocks, 108);
  }
}

TEST_F(FloorRecognizerTest, TheFloorIsKnownThroughBlurAndNoise) {
  for (const double blur_px : {1.0, 2.0}) {
    cv::Mat blurred;
    cv::GaussianBlur(Floor(1.0, 8.0), blurred, {}, blur_px);
    EXPECT_FALSE(recognizer_.Look(View(WithNoise(blurred, 1.5))).strange) << blur_px;
  }
  EXPECT_FALSE(recognizer_.Look(View(WithNoise(Floor(1.0, 8.0), 8.0))).strange);
}

TEST_F(FloorRecognizerTest, AQuarterOfTheFloorIsEnough) {
  cv::Mat half_hidden = Floor(1.0, 8.0);
  cv::RNG(4).fill(half_hidden(cv::Rect(0, 0, 432, 432)), cv::RNG::UNIFORM, 0.0, 255.0);
  EXPECT_FALSE(recognizer_.Look(View(half_hidden)).strange);
}

TEST_F(FloorRecognizerTest, AnotherTextureAllOverIsAnotherFloor) {
  const FloorVerdict view = recognizer_.Look(View(WithNoise(Floor(1.6, 45.0), 1.0)));
  EXPECT_TRUE(view.hopeless);
  EXPECT_EQ(view.strange, StrangeView::kOtherFloor);
}

TEST_F(FloorRecognizerTest, AnOverexposedViewIsInDoubt) {
  EXPECT_FALSE(recognizer_.Look(View(2.0 * Floor(1.6, 45.0))).hopeless);
}

TEST_F(FloorRecognizerTest, NoiseThatIsLikeADarkViewOfTheFloorIsSearchedForAndNamed) {
  const FloorVerdict view = recognizer_.Look(View(WithNoise(cv::Mat(432, 576, CV_32FC1, cv::Scalar(40.0)), 6.0)));
  EXPECT_FALSE(view.hopeless);
  EXPECT_EQ(view.strange, StrangeView::kNoFloor);
}

TEST_F(FloorRecognizerTest, DarknessGlareAndThingsAreNoFloor) {
  const cv::Mat plain(432, 576, CV_32FC1, cv::Scalar(3.0));
  EXPECT_EQ(recognizer_.Look(View(WithNoise(plain, 2.0))).strange, StrangeView::kNoFloor);
  EXPECT_EQ(recognizer_.Look(View(plain + 252.0)).strange, StrangeView::kNoFloor);
  cv::Mat things(432, 576, CV_32FC1);
  for (int k = 0; k < 3; ++k) {
    cv::Mat thing = things.colRange(192 * k, 192 * (k + 1));
    cv::RNG(5).fill(thing, cv::RNG::UNIFORM, 0.0, 60.0 + 70.0 * k);
  }
  const FloorVerdict view = recognizer_.Look(View(things));
  EXPECT_TRUE(view.hopeless);
  EXPECT_EQ(view.strange, StrangeView::kNoFloor);
}

TEST_F(FloorRecognizerTest, TheFloorsOfAllSurveysAreKnown) {
  const GroundImage other = View(WithNoise(Floor(1.6, 45.0), 1.0));
  EXPECT_TRUE(recognizer_.Look(other).hopeless);
  const FloorRecognizer both({model_, Learn(1.6, 45.0)});
  EXPECT_FALSE(both.Look(other).strange);
  EXPECT_FALSE(both.Look(View(WithNoise(Floor(1.0, 8.0), 1.0))).strange);
}

TEST_F(FloorRecognizerTest, NothingIsSaidWithoutAModelOrOfASmallView) {
  const GroundImage strange = View(WithNoise(Floor(1.6, 45.0), 1.0));
  EXPECT_FALSE(FloorRecognizer({}).Look(strange).hopeless);
  GroundImage small = strange;
  small.mask(cv::Rect(0, 0, 576, 384)).setTo(0);
  small.mask(cv::Rect(0, 0, 500, 432)).setTo(0);
  EXPECT_EQ(recognizer_.Look(small).blocks, 1);
  EXPECT_FALSE(recognizer_.Look(small).hopeless);
  EXPECT_FALSE(recognizer_.Look(GroundImage()).hopeless);
}

TEST(FloorModel, TheLeastTypicalBlocksDoNotWidenIt) {
  std::vector<BlockTexture> blocks;
  cv::RNG random(6);
  for (int i = 0; i < 400; ++i) {
    BlockTexture block;
    for (double& feature : block) {
      feature = random.gaussian(0.1) + (i % 10 == 0 ? 3.0 : 0.0);
    }
    blocks.push_back(block);
  }
  const FloorTextureModel model = LearnFloorTexture(blocks).value();
  EXPECT_LT(model.mean.cwiseAbs().maxCoeff(), 0.03);
  EXPECT_LT(model.covariance.diagonal().maxCoeff(), 0.1 * 0.1);
  EXPECT_EQ(model.blocks, 340);
}

TEST(FloorModel, FewOrEqualBlocksMakeNone) {
  EXPECT_FALSE(LearnFloorTexture(std::vector<BlockTexture>(99, BlockTexture::Ones())));
  EXPECT_FALSE(LearnFloorTexture(std::vector<BlockTexture>(200, BlockTexture::Ones())));
}

TEST(SeenUnderTest, NothingChangesNothingAndNoiseBecomesWhite) {
  const BlockTexture texture = (BlockTexture() << -3.0, 0.1, -0.2, -0.4, -1.2).finished();
  EXPECT_TRUE(SeenUnder(texture, {}).isApprox(texture, 1e-12));
  const BlockTexture drowned = SeenUnder(texture, {.noise_share = 10.0});
  EXPECT_NEAR(drowned(1), std::log(2.0), 1e-3);
  EXPECT_NEAR(drowned(2), -std::log(2.0), 1e-3);
}

TEST(FloorBlocks, OnlyWholeBlocksOfFloorCount) {
  GroundImage view = View(Floor(1.0, 8.0));
  EXPECT_EQ(MeasureFloorBlocks(view).size(), 108U);
  view.mask.at<std::uint8_t>(0, 0) = 0;
  EXPECT_EQ(MeasureFloorBlocks(view).size(), 107U);
}

}  // namespace
}  // namespace floorloc
