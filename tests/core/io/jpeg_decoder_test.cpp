// SPDX-License-Identifier: Apache-2.0
#include "core/io/jpeg_decoder.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>

namespace floorloc {
namespace {

using Bytes = std::vector<std::uint8_t>;

cv::Mat Noise(int channels) {
  cv::Mat image(120, 161, CV_8UC(channels));
  cv::theRNG().state = 5;
  cv::randu(image, 0, 256);
  return image;
}

Bytes Jpeg(const cv::Mat& image, const std::vector<int>& parameters = {}) {
  Bytes bytes;
  cv::imencode(".jpg", image, bytes, parameters);
  return bytes;
}

bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

// Where the compressed data begin: after the header of the first scan.
std::size_t DataBegin(const Bytes& bytes) {
  std::size_t i = 2;
  while (bytes[i + 1] != 0xDA) {
    i += 2U + bytes[i + 2] * 256U + bytes[i + 3];
  }
  return i + 2U + bytes[i + 2] * 256U + bytes[i + 3];
}

TEST(JpegDecoderTest, DecodesAsOpenCvDoes) {
  for (const int channels : {1, 3}) {
    for (const std::vector<int>& parameters :
         {std::vector<int>{}, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}, {cv::IMWRITE_JPEG_RST_INTERVAL, 3}}) {
      const Bytes bytes = Jpeg(Noise(channels), parameters);
      EXPECT_TRUE(AreEqual(DecodeJpeg(bytes, {}), cv::imdecode(bytes, cv::IMREAD_GRAYSCALE)));
      EXPECT_TRUE(AreEqual(DecodeJpeg(bytes, {true, 1}), cv::imdecode(bytes, cv::IMREAD_COLOR)));
      EXPECT_TRUE(AreEqual(DecodeJpeg(bytes, {true, 8}), cv::imdecode(bytes, cv::IMREAD_REDUCED_COLOR_8)));
    }
  }
}

TEST(JpegDecoderTest, DataThatHadToBeGuessedAreNoImage) {
  const Bytes whole = Jpeg(Noise(1));
  const std::size_t begin = DataBegin(whole);
  testing::internal::CaptureStderr();
  Bytes marker = whole;  // a stray marker in the middle
  marker[begin + 2000] = 0xFF;
  marker[begin + 2001] = 0xD9;
  EXPECT_TRUE(DecodeJpeg(marker, {}).empty());
  Bytes hole = whole;  // a lost packet
  hole.erase(hole.begin() + static_cast<std::ptrdiff_t>(begin) + 3000,
             hole.begin() + static_cast<std::ptrdiff_t>(begin) + 4400);
  EXPECT_TRUE(DecodeJpeg(hole, {}).empty());
  Bytes zeros = whole;
  std::fill_n(zeros.begin() + static_cast<std::ptrdiff_t>(begin) + 3000, 1400, std::uint8_t{0});
  EXPECT_TRUE(DecodeJpeg(zeros, {}).empty());
  EXPECT_TRUE(DecodeJpeg(Bytes(whole.begin(), whole.end() - 500), {}).empty());
  EXPECT_TRUE(DecodeJpeg(Bytes{1, 2, 3}, {}).empty());
  EXPECT_TRUE(DecodeJpeg({}, {}).empty());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(JpegDecoderTest, FewDamagedImagesPass) {
  const Bytes whole = Jpeg(Noise(1));
  const std::size_t begin = DataBegin(whole);
  std::mt19937 random(3);
  int passed = 0;
  for (int i = 0; i < 200; ++i) {
    Bytes bytes = whole;
    const std::size_t at = begin + random() % (bytes.size() - begin - 200);
    for (std::size_t k = 0; k < 64; ++k) {
      bytes[at + k] = static_cast<std::uint8_t>(random());
    }
    passed += DecodeJpeg(bytes, {}).empty() ? 0 : 1;
  }
  EXPECT_LE(passed, 20);
}

TEST(JpegDecoderTest, PaddingBeforeTheEndIsHarmless) {
  Bytes bytes = Jpeg(Noise(1));
  bytes.insert(bytes.end() - 2, 3, std::uint8_t{0});
  EXPECT_FALSE(DecodeJpeg(bytes, {}).empty());
}

}  // namespace
}  // namespace floorloc
