// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/ros_image.h"

#include <bit>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/io/image.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr std::uint32_t kMaxSidePx = 16384;
constexpr int kPngLevel = 1;  // a third of the time of the usual level for a twentieth more bytes

struct Encoding {
  int type = CV_8UC1;             // as in the message
  std::optional<int> conversion;  // to grey or BGR
};

// OpenCV names Bayer patterns by the second row: its BG is the RGGB of cameras.
const std::map<std::string, Encoding>& Encodings() {
  static const std::map<std::string, Encoding> kEncodings = {
      {"mono8", {CV_8UC1, {}}},
      {"8UC1", {CV_8UC1, {}}},
      {"mono16", {CV_16UC1, {}}},
      {"16UC1", {CV_16UC1, {}}},
      {"bgr8", {CV_8UC3, {}}},
      {"8UC3", {CV_8UC3, {}}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"bgr16", {CV_16UC3, {}}},
      {"rgb16", {CV_16UC3, cv::COLOR_RGB2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"bayer_rggb16", {CV_16UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr16", {CV_16UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg16", {CV_16UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg16", {CV_16UC1, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
  };
  return kEncodings;
}

[[noreturn]] void Fail(const std::string& topic, const std::string& what) {
  throw InputError("topic " + topic + ": " + what);
}

const Encoding& EncodingOf(const RosImage& image, const std::string& topic) {
  const auto found = Encodings().find(image.encoding);
  if (found == Encodings().end()) {
    Fail(topic, "its images have the encoding '" + image.encoding +
                    "'; record mono8, mono16, rgb8, bgr8, rgba8, bgra8, bayer_*, yuv422 or a compressed topic");
  }
  return found->second;
}

// Rows that are not a whole number of values long are copied, too.
cv::Mat CopyPixels(const RosImage& image, int type) {
  cv::Mat pixels(static_cast<int>(image.height_px), static_cast<int>(image.width_px), type);
  const std::size_t row_bytes = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  for (int row = 0; row < pixels.rows; ++row) {
    const auto from = image.data.subspan(static_cast<std::size_t>(row) * image.row_bytes, row_bytes);
    std::copy(from.begin(), from.end(), pixels.ptr(row));
  }
  return pixels;
}

void SwapBytes(cv::Mat* pixels) {
  for (int row = 0; row < pixels->rows; ++row) {
    auto* values = pixels->ptr<std::uint16_t>(row);
    for (int i = 0; i < pixels->cols * pixels->channels(); ++i) {
      values[i] = static_cast<std::uint16_t>((values[i] << 8) | (values[i] >> 8));
    }
  }
}

}  // namespace

cv::Mat DecodeRaw(const RosImage& image, const std::string& topic) {
  const Encoding& encoding = EncodingOf(image, topic);
  const bool halved = CV_MAT_CN(encoding.type) == 2;  // two pixels share their colour
  const bool bayer = CV_MAT_CN(encoding.type) == 1 && encoding.conversion;
  if (image.width_px == 0 || image.height_px == 0 || image.width_px > kMaxSidePx || image.height_px > kMaxSidePx ||
      (halved && image.width_px % 2 != 0) || (bayer && (image.width_px < 3 || image.height_px < 3))) {
    Fail(topic, "an image of " + std::to_string(image.width_px) + "x" + std::to_string(image.height_px) +
                    " pixels in " + image.encoding + " cannot be read; correct the driver, or leave the topic out");
  }
  const std::size_t row_bytes = image.width_px * static_cast<std::size_t>(CV_ELEM_SIZE(encoding.type));
  if (image.row_bytes < row_bytes ||
      image.data.size() < static_cast<std::size_t>(image.height_px - 1) * image.row_bytes + row_bytes) {
    Fail(topic, "an image has fewer bytes than its size and encoding need; the bag is damaged, or the driver wrong");
  }
  cv::Mat pixels = CopyPixels(image, encoding.type);
  if (pixels.depth() == CV_16U && image.big_endian != (std::endian::native == std::endian::big)) {
    SwapBytes(&pixels);
  }
  if (!encoding.conversion) {
    return pixels;
  }
  cv::Mat converted;
  cv::cvtColor(pixels, converted, *encoding.conversion);
  return converted;
}

ImageFile ToImageFile(const BagMessage& message) {
  const std::string& topic = message.connection->topic;
  ImageFile file;
  if (PlainType(message.connection->type) == "sensor_msgs/Image") {
    file.extension = ".png";
    cv::imencode(".png", DecodeRaw(ParseImage(message), topic), file.bytes, {cv::IMWRITE_PNG_COMPRESSION, kPngLevel});
    return file;
  }
  const RosCompressedImage image = ParseCompressedImage(message);
  const std::optional<ImageHeader> header = ProbeImage(image.data);
  if (!header) {
    Fail(topic, "an image (format '" + image.format +
                    "') is neither JPEG nor PNG, or damaged; record a topic of image_transport's compressed images");
  }
  file.extension = header->format == ImageFormat::kJpeg ? ".jpg" : ".png";
  file.bytes.assign(image.data.begin(), image.data.end());
  return file;
}

}  // namespace floorloc
