// SPDX-License-Identifier: Apache-2.0
#include "core/io/image.h"

#include <fstream>

#include "core/io/encoded_image.h"
#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing_io::EncodedImage;
using testing_io::ErrorOf;
using testing_io::TemporaryFolder;

using Bytes = std::vector<std::uint8_t>;

std::string DecodeError(const Bytes& bytes, int width_px = 40, int height_px = 30) {
  return ErrorOf([&] { DecodeGray(bytes, width_px, height_px, "a.jpg"); });
}

std::size_t Find(const Bytes& bytes, std::uint8_t first, std::uint8_t second) {
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    if (bytes[i] == first && bytes[i + 1] == second) {
      return i;
    }
  }
  ADD_FAILURE() << "marker not found";
  return 0;
}

class ImageFormats : public ::testing::TestWithParam<const char*> {};

TEST_P(ImageFormats, ProbesTheHeaderAndDecodes) {
  const Bytes bytes = EncodedImage(GetParam(), 40, 30);
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->width_px, 40);
  EXPECT_EQ(header->height_px, 30);
  EXPECT_EQ(header->bits, 8);
  EXPECT_EQ(header->format, GetParam() == std::string(".png") ? ImageFormat::kPng : ImageFormat::kJpeg);
  const cv::Mat gray = DecodeGray(bytes, 40, 30, "a");
  EXPECT_EQ(gray.type(), CV_8UC1);
  EXPECT_EQ(gray.size(), cv::Size(40, 30));
  const cv::Mat color = DecodeColor(bytes, 40, 30, "a");
  EXPECT_EQ(color.type(), CV_8UC3);
  EXPECT_NEAR(color.at<cv::Vec3b>(20, 10)[1], 20, 25) << "green is the row number";
}

TEST_P(ImageFormats, EveryCutOffFileIsRefused) {
  const Bytes bytes = EncodedImage(GetParam(), 40, 30);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(DecodeError(cut), StartsWith("a.jpg: ")) << size << " of " << bytes.size() << " bytes";
  }
}

TEST_P(ImageFormats, RefusesImagesOfAnotherSize) {
  EXPECT_THAT(DecodeError(EncodedImage(GetParam(), 40, 30), 640, 480),
              AllOf(HasSubstr("the image is 40x30 but camera.yaml says 640x480"),
                    HasSubstr("use images of the calibrated camera")));
}

INSTANTIATE_TEST_SUITE_P(All, ImageFormats, ::testing::Values(".jpg", ".png"),
                         [](const auto& test) { return std::string(test.param).substr(1); });

TEST(Image, IgnoresTheOrientationTag) {
  Bytes bytes = EncodedImage(".jpg", 40, 30);
  // An APP1 segment with one EXIF tag: orientation 6 (rotate 90 degrees clockwise).
  const Bytes exif = {0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0, 0, 'M', 'M', 0, 42, 0, 0, 0, 8,
                      0,    1,    1, 18, 0,   3,   0,   0,   0, 1, 0,   6,   0, 0,  0, 0, 0, 0};
  bytes.insert(bytes.begin() + 2, exif.begin(), exif.end());
  EXPECT_EQ(DecodeGray(bytes, 40, 30, "a.jpg").size(), cv::Size(40, 30));
}

TEST(Image, ProgressiveJpegsAndTrailingBytesAreFine) {
  cv::Mat image(30, 40, CV_8UC1, cv::Scalar(77));
  Bytes bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 1});
  EXPECT_GT(CountJpegScans(bytes).value_or(0), 1);
  bytes.insert(bytes.end(), 5000, 0);
  EXPECT_EQ(DecodeGray(bytes, 40, 30, "a.jpg").at<std::uint8_t>(15, 20), 77);
}

TEST(Image, RefusesAJpegWhoseEndIsOnlyThatOfItsThumbnail) {
  Bytes bytes = EncodedImage(".jpg", 40, 30);
  bytes.resize(bytes.size() - 100);
  // A comment segment that contains a complete image including the end marker.
  const Bytes comment = {0xFF, 0xFE, 0, 6, 0xFF, 0xD8, 0xFF, 0xD9};
  bytes.insert(bytes.begin() + 2, comment.begin(), comment.end());
  EXPECT_THAT(DecodeError(bytes), HasSubstr("cut off"));
}

TEST(Image, RefusesAJpegOfThousandsOfScans) {
  Bytes bytes = EncodedImage(".jpg", 40, 30);
  const Bytes scan = {0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0, 0x12, 0x34};
  for (int i = 0; i < 1000; ++i) {
    bytes.insert(bytes.end() - 2, scan.begin(), scan.end());
  }
  EXPECT_EQ(CountJpegScans(bytes), 1001);
  EXPECT_THAT(DecodeError(bytes), HasSubstr("more than 100 scans"));
}

TEST(Image, RefusesHugeImagesBeforeDecoding) {
  Bytes bytes = EncodedImage(".png", 40, 30);
  bytes[18] = 0x7F;  // the width is now 32552
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  ASSERT_TRUE(header.has_value());
  EXPECT_THAT(DecodeError(bytes, header->width_px, header->height_px), HasSubstr("larger than 16384 pixels"));
}

TEST(Image, RefusesWhatIsNoImage) {
  EXPECT_FALSE(ProbeImage({}).has_value());
  for (const std::string text : {"", "GIF89a", "BM", "\xFF\xD8", "\xFF\xD8\xFF", "\x89PNG\r\n\x1A\n"}) {
    const Bytes bytes(text.begin(), text.end());
    EXPECT_FALSE(ProbeImage(bytes).has_value()) << text;
    EXPECT_THAT(DecodeError(bytes), HasSubstr("is not a JPEG or PNG"));
  }
}

TEST(Image, RefusesDamagedHeaders) {
  Bytes no_height = EncodedImage(".jpg", 40, 30);
  const std::size_t frame = Find(no_height, 0xFF, 0xC0);
  no_height[frame + 5] = no_height[frame + 6] = 0;
  EXPECT_FALSE(ProbeImage(no_height).has_value());

  Bytes short_frame = EncodedImage(".jpg", 40, 30);
  short_frame[frame + 2] = 0;
  short_frame[frame + 3] = 5;
  EXPECT_FALSE(ProbeImage(short_frame).has_value());

  Bytes scan_first = EncodedImage(".jpg", 40, 30);
  scan_first[frame + 1] = 0xFE;
  EXPECT_FALSE(ProbeImage(scan_first).has_value());

  Bytes no_width = EncodedImage(".png", 40, 30);
  no_width[19] = 0;
  EXPECT_FALSE(ProbeImage(no_width).has_value());
  no_width[16] = 0xFF;
  EXPECT_FALSE(ProbeImage(no_width).has_value());
}

// A PNG of 16 bits per channel with a ramp from 0 to `top`, times `factor`.
Bytes Png16(int top, int factor, int type = CV_16UC1) {
  cv::Mat image(30, 40, CV_16UC1);
  for (int i = 0; i < 1200; ++i) {
    image.at<std::uint16_t>(i / 40, i % 40) = static_cast<std::uint16_t>(top * i / 1199 * factor);
  }
  if (type == CV_16UC3) {
    cv::merge(std::vector<cv::Mat>(3, image), image);
  }
  Bytes bytes;
  cv::imencode(".png", image, bytes);
  return bytes;
}

TEST(Image, SensorsOfMoreThan8BitsFillTheRangeOfGrey) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    const int top = (1 << bits) - 1;
    const cv::Mat gray = DecodeGray(Png16(top, 1), 40, 30, "a.png");
    EXPECT_EQ(gray.type(), CV_8UC1);
    for (const int i : {0, 1, 7, 300, 1198, 1199}) {
      EXPECT_EQ(gray.at<std::uint8_t>(i / 40, i % 40), (top * i / 1199) >> (bits - 8)) << bits << " bits";
    }
    EXPECT_EQ(DecodeColor(Png16(top, 1, CV_16UC3), 40, 30, "a.png").at<cv::Vec3b>(29, 39), cv::Vec3b(255, 255, 255));
  }
}

TEST(Image, ADarkImageStaysDarkWhereTheSensorsBitsAreAtTheTop) {
  const cv::Mat gray = DecodeGray(Png16(255, 16), 40, 30, "a.png");  // 12 bits, shifted by 4; a sixteenth of the light
  EXPECT_EQ(gray.at<std::uint8_t>(29, 39), 15);
  const cv::Mat black = DecodeGray(Png16(0, 1), 40, 30, "a.png");
  EXPECT_EQ(black.at<std::uint8_t>(29, 39), 0);
}

TEST(Image, RefusesAJpegOf12Bits) {
  Bytes bytes = EncodedImage(".jpg", 40, 30);
  bytes[Find(bytes, 0xFF, 0xC0) + 4] = 12;
  EXPECT_THAT(DecodeError(bytes), HasSubstr("is a JPEG of 12 bits per channel"));
}

TEST(Image, RefusesDamagedPixels) {
  Bytes bytes = EncodedImage(".png", 40, 30);
  bytes[60] ^= 0x55;
  EXPECT_THAT(DecodeError(bytes), HasSubstr("damaged"));
}

TEST(Image, ReadsFilesAndNamesThem) {
  const TemporaryFolder folder;
  const Bytes bytes = EncodedImage(".png", 40, 30);
  std::ofstream(folder.path() / "a.png") << std::string(bytes.begin(), bytes.end());
  EXPECT_EQ(ReadGrayImage(folder.path() / "a.png", 40, 30).channels(), 1);
  EXPECT_EQ(ReadColorImage(folder.path() / "a.png", 40, 30).channels(), 3);
  EXPECT_THAT(ErrorOf([&] { ReadGrayImage(folder.path() / "a.png", 41, 30); }), HasSubstr("a.png: the image is"));
  EXPECT_THAT(ErrorOf([&] { ReadGrayImage(folder.path() / "b.png", 40, 30); }), HasSubstr("b.png: cannot be opened"));
}

}  // namespace
}  // namespace floorloc
