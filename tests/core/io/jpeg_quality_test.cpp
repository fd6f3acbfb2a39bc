// SPDX-License-Identifier: Apache-2.0
#include "core/io/jpeg_quality.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace floorloc {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes JpegOf(int quality) {
  cv::Mat image(64, 64, CV_8UC3);
  cv::randu(image, 0, 256);
  Bytes bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return bytes;
}

// Position of the table of the luminance: after the marker, the length and the table's number.
std::size_t FirstTable(const Bytes& bytes) {
  for (std::size_t i = 0; i + 5 < bytes.size(); ++i) {
    if (bytes[i] == 0xFF && bytes[i + 1] == 0xDB) {
      return i + 5;
    }
  }
  ADD_FAILURE() << "there is no table";
  return 0;
}

TEST(JpegQualityTest, IsWhatTheEncoderWasTold) {
  for (const int quality : {3, 8, 20, 30, 39, 40, 50, 75, 90, 95}) {
    const std::optional<int> estimated = EstimateJpegQuality(JpegOf(quality));
    ASSERT_TRUE(estimated.has_value()) << quality;
    EXPECT_NEAR(*estimated, quality, 1) << quality;
  }
  EXPECT_GE(EstimateJpegQuality(JpegOf(100)).value_or(0), 95) << "all steps are 1 from 97 on";
}

TEST(JpegQualityTest, OtherTablesOfACameraCountByWhatTheyLose) {
  Bytes bytes = JpegOf(50);
  const std::size_t table = FirstTable(bytes);
  for (std::size_t i = 0; i < 64; ++i) {
    bytes[table + i] = 40;  // three times as coarse as quality 50 in the lowest frequencies
  }
  EXPECT_NEAR(EstimateJpegQuality(bytes).value_or(0), 17, 1);
}

TEST(JpegQualityTest, DamagedOrOtherFilesHaveNone) {
  const Bytes good = JpegOf(50);
  const std::size_t table = FirstTable(good);
  Bytes zero = good;
  zero[table] = 0;
  Bytes number = good;
  number[table - 1] = 0x05;
  Bytes precision = good;
  precision[table - 1] = 0x20;
  Bytes wide = good;
  wide[table - 1] = 0x10;  // 16 bits per entry: the segment is too short
  for (const Bytes& bytes : {zero, number, precision, wide, Bytes(good.begin(), good.begin() + 40), Bytes()}) {
    EXPECT_EQ(EstimateJpegQuality(bytes), std::nullopt);
  }
  Bytes png;
  cv::imencode(".png", cv::Mat(8, 8, CV_8UC1, cv::Scalar(7)), png);
  EXPECT_EQ(EstimateJpegQuality(png), std::nullopt);
}

TEST(JpegQualityTest, EveryCutOffHeaderHasNone) {
  const Bytes good = JpegOf(20);
  for (std::size_t size = 0; size < 200; ++size) {
    EXPECT_EQ(EstimateJpegQuality(std::span(good).first(size)), std::nullopt) << size;
  }
}

TEST(JpegQualityTest, TheSentenceSaysTheQualityAndWhatToDo) {
  EXPECT_THAT(CompressedTooMuch(20), testing::AllOf(testing::HasSubstr("JPEG quality 20"),
                                                    testing::HasSubstr("set the camera to a quality of 50")));
}

}  // namespace
}  // namespace floorloc
