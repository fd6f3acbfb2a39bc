// SPDX-License-Identifier: Apache-2.0
#include "core/io/encoded_image.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/io/image.h"

namespace floorloc {
namespace {

using Bytes = std::span<const std::uint8_t>;

// ITU T.81, table B.1.
constexpr std::uint8_t kStartOfImage = 0xD8;
constexpr std::uint8_t kEndOfImage = 0xD9;
constexpr std::uint8_t kStartOfScan = 0xDA;

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
