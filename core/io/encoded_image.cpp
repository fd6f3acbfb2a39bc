// SPDX-License-Identifier: Apache-2.0
#include "core/io/encoded_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/io/image.h"
#include "core/io/jpeg_quality.h"

namespace floorloc {
namespace {

using Bytes = std::span<const std::uint8_t>;

// ITU T.81, table B.1.
constexpr std::uint8_t kStartOfImage = 0xD8;
constexpr std::uint8_t kEndOfImage = 0xD9;
constexpr std::uint8_t kStartOfScan = 0xDA;
constexpr std::uint8_t kQuantization = 0xDB;

bool IsFrameHeader(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}
bool IsRestart(std::uint8_t marker) { return marker >= 0xD0 && marker <= 0xD7; }

// One marker segment of a JPEG; `payload` follows the two bytes of length.
struct Segment {
  std::uint8_t marker = 0;
  Bytes payload;
};

// Iterates over the segments.
class JpegParser {
 public:
  explicit JpegParser(Bytes bytes) : rest_(bytes) {}

  bool StartsAsJpeg() {
    const bool ok = rest_.size() >= 3 && rest_[0] == 0xFF && rest_[1] == kStartOfImage && rest_[2] == 0xFF;
    rest_ = ok ? rest_.subspan(2) : Bytes{};
    return ok;
  }

  // The next segment; empty when there is no complete one.
  std::optional<Segment> Next() {
    if (rest_.empty() || rest_[0] != 0xFF) {
      return std::nullopt;
    }
    const auto code = std::find_if(rest_.begin(), rest_.end(), [](std::uint8_t b) { return b != 0xFF; });
    if (code == rest_.end()) {
      return std::nullopt;
    }
    const std::uint8_t marker = *code;
    rest_ = rest_.subspan(static_cast<std::size_t>(code - rest_.begin()) + 1);
    if (marker == kEndOfImage) {
      return Segment{marker, {}};
    }
    if (rest_.size() < 2) {
      return std::nullopt;
    }
    const std::size_t length = static_cast<std::size_t>(rest_[0]) * 256 + rest_[1];
    if (length < 2 || length > rest_.size()) {
      return std::nullopt;
    }
    const Segment segment{marker, rest_.subspan(2, length - 2)};
    rest_ = rest_.subspan(length);
    return segment;
  }

  // Compressed data ends at a marker that is neither a stuffed zero nor a restart.
  void SkipCompressedData() {
    auto position = rest_.begin();
    while (true) {
      position = std::find(position, rest_.end(), std::uint8_t{0xFF});
      if (rest_.end() - position < 2) {
        rest_ = {};
        return;
      }
      const std::uint8_t code = *(position + 1);
      if (code != 0x00 && !IsRestart(code)) {
        rest_ = rest_.subspan(static_cast<std::size_t>(position - rest_.begin()));
        return;
      }
      position += 2;
    }
  }

 private:
  Bytes rest_;
};

std::optional<ImageHeader> ProbeJpeg(Bytes bytes) {
  JpegParser parser(bytes);
  if (!parser.StartsAsJpeg()) {
    return std::nullopt;
  }
  while (const std::optional<Segment> segment = parser.Next()) {
    const Bytes data = segment->payload;
    if (segment->marker == kStartOfScan || segment->marker == kEndOfImage) {
      return std::nullopt;
    }
    if (IsFrameHeader(segment->marker)) {
      if (data.size() < 6) {
        return std::nullopt;
      }
      const int height = data[1] * 256 + data[2];
      const int width = data[3] * 256 + data[4];
      return width > 0 && height > 0 ? std::optional(ImageHeader{ImageFormat::kJpeg, width, height, data[0]})
                                     : std::nullopt;
    }
  }
  return std::nullopt;
}

// The lowest frequencies of the luminance, in the order of the file (T.81 table K.1).
constexpr std::array<int, 10> kLowFrequencies = {16, 11, 12, 14, 12, 10, 16, 14, 13, 14};
using LowFrequencies = std::array<int, kLowFrequencies.size()>;

// The quantisation tables by their numbers (T.81 B.2.4.1).
using QuantizationTables = std::array<std::optional<LowFrequencies>, 4>;

// Adds the tables of a segment; false when it is damaged.
bool AddTables(Bytes data, QuantizationTables* tables) {
  constexpr std::size_t kEntries = 64;
  while (!data.empty()) {
    const std::size_t bytes = (data[0] >> 4U) + std::size_t{1};
    const std::size_t number = data[0] & 0x0FU;
    data = data.subspan(1);
    if (bytes > 2 || number >= tables->size() || data.size() < bytes * kEntries) {
      return false;
    }
    LowFrequencies steps{};
    for (std::size_t i = 0; i < steps.size(); ++i) {
      steps[i] = bytes == 2 ? data[2 * i] * 256 + data[2 * i + 1] : data[i];
    }
    if (std::find(steps.begin(), steps.end(), 0) != steps.end()) {
      return false;
    }
    (*tables)[number] = steps;
    data = data.subspan(bytes * kEntries);
  }
  return true;
}

// The number of the table of the first component (T.81 B.2.2).
std::optional<std::size_t> FirstTable(Bytes frame_header) {
  constexpr std::size_t kTable = 8;
  return frame_header.size() > kTable && frame_header[kTable] < QuantizationTables().size()
             ? std::optional<std::size_t>(frame_header[kTable])
             : std::nullopt;
}

int QualityOf(const LowFrequencies& steps) {
  const double scale = 100.0 * std::accumulate(steps.begin(), steps.end(), 0) /
                       std::accumulate(kLowFrequencies.begin(), kLowFrequencies.end(), 0);
  const double quality = scale > 100.0 ? 5000.0 / scale : 100.0 - 0.5 * scale;
  return std::clamp(static_cast<int>(std::lround(quality)), 1, 100);
}

std::uint32_t BigEndian32(Bytes bytes) {
  return static_cast<std::uint32_t>(bytes[0]) << 24 | static_cast<std::uint32_t>(bytes[1]) << 16 |
         static_cast<std::uint32_t>(bytes[2]) << 8 | static_cast<std::uint32_t>(bytes[3]);
}

// Signature, then the IHDR chunk: length 13, name, width, height, bit depth.
std::optional<ImageHeader> ProbePng(Bytes bytes) {
  constexpr std::array<std::uint8_t, 16> kStart = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                   0,    0,   0,   13,  'I',  'H',  'D',  'R'};
  constexpr std::size_t kHeaderSize = 25;
  if (bytes.size() < kHeaderSize || !std::equal(kStart.begin(), kStart.end(), bytes.begin())) {
    return std::nullopt;
  }
  constexpr std::uint32_t kMax = std::numeric_limits<std::int32_t>::max();
  const std::uint32_t width = BigEndian32(bytes.subspan(16));
  const std::uint32_t height = BigEndian32(bytes.subspan(20));
  if (width == 0 || height == 0 || width > kMax || height > kMax) {
    return std::nullopt;
  }
  return ImageHeader{ImageFormat::kPng, static_cast<int>(width), static_cast<int>(height), bytes[24]};
}

}  // namespace

std::optional<ImageHeader> ProbeImage(std::span<const std::uint8_t> bytes) {
  const std::optional<ImageHeader> jpeg = ProbeJpeg(bytes);
  return jpeg ? jpeg : ProbePng(bytes);
}

std::optional<int> EstimateJpegQuality(std::span<const std::uint8_t> bytes) {
  JpegParser parser(bytes);
  if (!parser.StartsAsJpeg()) {
    return std::nullopt;
  }
  QuantizationTables tables;
  std::optional<std::size_t> first;
  while (const std::optional<Segment> segment = parser.Next()) {
    if (segment->marker == kQuantization && !AddTables(segment->payload, &tables)) {
      return std::nullopt;
    }
    if (IsFrameHeader(segment->marker)) {
      first = FirstTable(segment->payload);
    }
    if (segment->marker == kStartOfScan) {
      return first && tables[*first] ? std::optional(QualityOf(*tables[*first])) : std::nullopt;
    }
  }
  return std::nullopt;
}

std::string CompressedTooMuch(int jpeg_quality) {
  return "images are compressed too much, JPEG quality " + std::to_string(jpeg_quality) +
         ": what the floor is recognized by is lost; set the camera to a quality of 50 or more, or to a higher bit "
         "rate";
}

std::optional<int> CountJpegScans(std::span<const std::uint8_t> bytes) {
  JpegParser parser(bytes);
  if (!parser.StartsAsJpeg()) {
    return std::nullopt;
  }
  int scans = 0;
  while (const std::optional<Segment> segment = parser.Next()) {
    if (segment->marker == kEndOfImage) {
      return scans;
    }
    if (segment->marker == kStartOfScan) {
      ++scans;
      parser.SkipCompressedData();
    }
  }
  return std::nullopt;
}

bool HasPngEnd(std::span<const std::uint8_t> bytes) {
  // A chunk consists of length, name, data and checksum.
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kFrame = 12;
  constexpr std::uint32_t kEnd = 0x49454E44;  // "IEND"
  Bytes rest = bytes.subspan(std::min(kSignature, bytes.size()));
  while (rest.size() >= kFrame) {
    const std::size_t length = BigEndian32(rest);
    if (length > rest.size() - kFrame) {
      return false;
    }
    if (BigEndian32(rest.subspan(4)) == kEnd) {
      return true;
    }
    rest = rest.subspan(kFrame + length);
  }
  return false;
}

}  // namespace floorloc
