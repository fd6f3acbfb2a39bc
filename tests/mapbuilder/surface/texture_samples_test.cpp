// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/texture_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

cv::Mat Flat(cv::Size size, int level) { return {size, CV_8UC1, cv::Scalar(level)}; }

// The left half has spots, the right half nothing to track.
cv::Mat HalfRoughFloor() {
  cv::Mat floor(240, 400, CV_8UC1);
  cv::RNG(6).fill(floor, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(floor, floor, {}, 1.5);
  cv::normalize(floor, floor, 0, 255, cv::NORM_MINMAX);
  floor.colRange(200, 400).setTo(100);
  return floor;
}

std::size_t Count(const TextureSamples& samples, std::size_t of_class) {
  return samples.training[of_class].size() + samples.testing[of_class].size();
}

class TextureSamplesTest : public ::testing::Test {
 protected:
  void Write(const std::string& name, const cv::Mat& image) const {
    const std::filesystem::path file = folder_.path() / name;
    std::filesystem::create_directories(file.parent_path());
    cv::imwrite(file.string(), image);
  }
  void WritePair(const std::string& folder) const {
    Write(folder + "9.png", HalfRoughFloor()(cv::Rect(40, 0, 320, 240)));
    Write(folder + "10.png", HalfRoughFloor()(cv::Rect(42, 0, 320, 240)));
  }
  TextureSamples Read(const TextureSampleOptions& options = {}) const {
    return ReadTextureSamples(folder_.path(), options);
  }
  std::string Refusal() const {
    try {
      Read();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(TextureSamplesTest, FoldersNameTheClassesOfTheirImages) {
  for (const std::string name : {"1.png", "2.jpg", "3.png", "4.png"}) {
    Write("Rough/" + name, Flat({32, 24}, 90));
    Write("SMOOTH/" + name, Flat({32, 24}, 60));
    Write("shadow/" + name, Flat({32, 24}, 20));
  }
  const TextureSamples samples = Read();
  for (std::size_t i = 0; i < kTextureClasses.size(); ++i) {
    EXPECT_EQ(samples.training[i].size(), 3U);
    EXPECT_EQ(samples.testing[i].size(), 1U);
  }
  EXPECT_EQ(samples.training[0][0](0), 90.0);
  EXPECT_EQ(samples.testing[1][0](0), 60.0);
}

TEST_F(TextureSamplesTest, WholeImagesAreDividedAndTheirBlocksStayTogether) {
  for (const std::string name : {"1.png", "2.png"}) {
    Write("rough/" + name, Flat({640, 480}, 90));
    Write("smooth/" + name, Flat({320, 240}, 60));
  }
  const TextureSamples samples = Read();
  EXPECT_EQ(samples.training[0].size(), 12U);
  EXPECT_EQ(samples.testing[0].size(), 12U);
  EXPECT_EQ(Count(samples, 1), 24U);
}

TEST_F(TextureSamplesTest, BlocksOfSequencesAreLabelledByTheirTracks) {
  WritePair("");
  const TextureSamples samples = Read();
  EXPECT_EQ(Count(samples, 0), 6U);
  EXPECT_EQ(Count(samples, 1), 6U);
  EXPECT_EQ(Count(samples, 2), 0U);
  EXPECT_FALSE(samples.testing[0].empty());
  EXPECT_FALSE(samples.testing[1].empty());
}

TEST_F(TextureSamplesTest, EachSubfolderIsASequence) {
  WritePair("gravel/");
  WritePair("sand/images/");
  const TextureSamples samples = Read();
  EXPECT_EQ(Count(samples, 0), 12U);
  EXPECT_EQ(Count(samples, 1), 12U);
}

TEST_F(TextureSamplesTest, WholeImagesMayBeLabelled) {
  WritePair("spots/");
  Write("bare/1.png", Flat({320, 240}, 80));
  Write("bare/2.png", Flat({320, 240}, 80));
  TextureSampleOptions options;
  options.tracks.by_block = false;
  const TextureSamples samples = Read(options);
  EXPECT_EQ(Count(samples, 0), 12U);
  EXPECT_EQ(Count(samples, 1), 12U);
}

TEST_F(TextureSamplesTest, WhatCannotBeLabelledIsRefused) {
  EXPECT_THAT(Refusal(), HasSubstr("neither subfolders rough and smooth"));
  Write("0.png", Flat({32, 24}, 9));
  EXPECT_THAT(Refusal(), HasSubstr("nor two images in a row"));
  Write("1.png", Flat({40, 24}, 9));
  EXPECT_THAT(Refusal(), HasSubstr("another size"));
  Write("1.png", Flat({32, 24}, 9));
  EXPECT_THAT(Refusal(), HasSubstr("only 0 blocks are ROUGH"));
  Write("rough/1.png", Flat({32, 24}, 9));
  EXPECT_THAT(Refusal(), HasSubstr("has one image only"));
  Write("rough/2.png", Flat({32, 24}, 9));
  EXPECT_THAT(Refusal(), HasSubstr("no images of class SMOOTH"));
  WriteFileAtomically(folder_.path() / "rough" / "2.png", "no image");
  EXPECT_THAT(Refusal(), HasSubstr("2.png"));
  EXPECT_THROW(ReadTextureSamples(folder_.path() / "none"), InputError);
  TextureSampleOptions options;
  options.test_share = 1.0;
  EXPECT_THROW(Read(options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
