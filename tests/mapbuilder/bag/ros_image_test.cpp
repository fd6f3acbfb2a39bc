// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/ros_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

// Two rows of two pixels, with a byte of padding behind each row.
RosImage MakeImage(const std::string& encoding, const std::vector<std::uint8_t>& data, std::uint32_t width = 2) {
  RosImage image;
  image.encoding = encoding;
  image.width_px = width;
  image.height_px = 2;
  image.row_bytes = static_cast<std::uint32_t>(data.size() / 2);
  image.data = data;
  return image;
}

TEST(RosImageTest, ColoursAreInTheOrderOfTheEncoding) {
  const std::vector<std::uint8_t> data = {1, 2, 3, 4, 5, 6, 0, 7, 8, 9, 10, 11, 12, 0};
  EXPECT_EQ(DecodeRaw(MakeImage("rgb8", data), "/a").at<cv::Vec3b>(0, 1), cv::Vec3b(6, 5, 4));
  EXPECT_EQ(DecodeRaw(MakeImage("bgr8", data), "/a").at<cv::Vec3b>(1, 0), cv::Vec3b(7, 8, 9));
  const std::vector<std::uint8_t> alpha = {1, 2, 3, 99, 4, 5, 6, 99, 0, 7, 8, 9, 99, 10, 11, 12, 99, 0};
  EXPECT_EQ(DecodeRaw(MakeImage("rgba8", alpha), "/a").at<cv::Vec3b>(1, 1), cv::Vec3b(12, 11, 10));
  EXPECT_EQ(DecodeRaw(MakeImage("bgra8", alpha), "/a").at<cv::Vec3b>(1, 1), cv::Vec3b(10, 11, 12));
}

TEST(RosImageTest, SixteenBitsHaveEitherByteOrder) {
  const std::vector<std::uint8_t> data = {0x34, 0x12, 0x78, 0x56, 0, 1, 2, 3, 4, 0};
  RosImage image = MakeImage("mono16", data);
  EXPECT_EQ(DecodeRaw(image, "/a").at<std::uint16_t>(0, 1), 0x5678);
  image.big_endian = true;
  EXPECT_EQ(DecodeRaw(image, "/a").at<std::uint16_t>(0, 1), 0x7856);
}

// A uniform red floor, as each pattern sees it.
TEST(RosImageTest, BayerPatternsAreTheirs) {
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    std::vector<std::uint8_t> data;
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 8; ++column) {
        data.push_back(pattern[static_cast<std::size_t>(2 * (row % 2) + column % 2)] == 'r' ? 200 : 10);
      }
    }
    RosImage image = MakeImage("bayer_" + pattern + "8", data, 8);
    image.height_px = 8;
    image.row_bytes = 8;
    EXPECT_EQ(DecodeRaw(image, "/a").at<cv::Vec3b>(4, 4), cv::Vec3b(10, 10, 200)) << pattern;
  }
}

TEST(RosImageTest, BothOrdersOfYuv422) {
  // Grey of two brightnesses: U and V are 128.
  const std::vector<std::uint8_t> uyvy = {128, 126, 128, 235, 128, 16, 128, 16};
  const std::vector<std::uint8_t> yuyv = {126, 128, 235, 128, 16, 128, 16, 128};
  for (const cv::Mat& image :
       {DecodeRaw(MakeImage("yuv422", uyvy), "/a"), DecodeRaw(MakeImage("yuv422_yuy2", yuyv), "/a")}) {
    EXPECT_NEAR(image.at<cv::Vec3b>(0, 0)[0], 128, 1);
    EXPECT_EQ(image.at<cv::Vec3b>(0, 1), cv::Vec3b(255, 255, 255));
    EXPECT_EQ(image.at<cv::Vec3b>(1, 1), cv::Vec3b(0, 0, 0));
  }
}

std::string ErrorOf(const RosImage& image) {
  try {
    DecodeRaw(image, "/camera");
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(RosImageTest, RefusesWhatItsBytesCannotBe) {
  const std::vector<std::uint8_t> data(8, 1);
  EXPECT_THAT(ErrorOf(MakeImage("nv21", data)), HasSubstr("topic /camera: its images have the encoding 'nv21'"));
  EXPECT_THAT(ErrorOf(MakeImage("rgb8", data)), HasSubstr("fewer bytes"));
  EXPECT_THAT(ErrorOf(MakeImage("mono8", data, 0)), HasSubstr("0x2"));
  EXPECT_THAT(ErrorOf(MakeImage("mono8", data, 1u << 31)), HasSubstr("cannot be read"));
  EXPECT_THAT(ErrorOf(MakeImage("yuv422", data, 1)), HasSubstr("1x2"));
  RosImage image = MakeImage("mono8", data);
  image.height_px = 16000;
  EXPECT_THAT(ErrorOf(image), HasSubstr("fewer bytes"));
}

}  // namespace
}  // namespace floorloc
