// SPDX-License-Identifier: Apache-2.0
#include "core/io/jpeg_decoder.h"

#include <csetjmp>
#include <cstdio>

// After <cstdio>: jpeglib.h uses FILE without including it.
#include <jerror.h>
#include <jpeglib.h>

namespace floorloc {
namespace {

constexpr int kEndOfImage = 0xD9;
// Webcams pad their last segment by a few bytes. Data that lost a code leave more, as a rule, or too few.
constexpr int kMaxPaddingBytes = 8;

struct ErrorHandler {
  jpeg_error_mgr base;  // first: libjpeg knows this part only
  std::jmp_buf escape;
};

// libjpeg is C: no exception may pass through it.
[[noreturn]] void OnError(j_common_ptr info) { std::longjmp(reinterpret_cast<ErrorHandler*>(info->err)->escape, 1); }

bool IsHarmless(const jpeg_error_mgr& error) {
  switch (error.msg_code) {
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
    case JWRN_BOGUS_ICC:
      return true;  // not about pixels
    case JWRN_EXTRANEOUS_DATA:
      return error.msg_parm.i[0] <= kMaxPaddingBytes && error.msg_parm.i[1] == kEndOfImage;
    default:
      return false;
  }
}

// level: -1 for warnings, otherwise how chatty the message is.
void OnMessage(j_common_ptr info, int level) {
  if (level < 0 && !IsHarmless(*info->err)) {
    OnError(info);
  }
}

void PrintNothing(j_common_ptr) {}

// Each function that calls libjpeg has nothing to destroy when it is left by longjmp.
class JpegReader {
 public:
  JpegReader() {
    info_.err = jpeg_std_error(&errors_.base);
    errors_.base.error_exit = OnError;
    errors_.base.emit_message = OnMessage;
    errors_.base.output_message = PrintNothing;
    jpeg_create_decompress(&info_);
  }
  ~JpegReader() { jpeg_destroy_decompress(&info_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  bool Start(std::span<const std::uint8_t> bytes, const JpegDecoding& decoding) {
    if (setjmp(errors_.escape) != 0) {  // NOLINT(cert-err52-cpp): libjpeg's way
      return false;
    }
    jpeg_mem_src(&info_, bytes.data(), static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&info_, TRUE);
    if (info_.num_components == 4) {
      return false;
    }
    info_.scale_num = 1;
    info_.scale_denom = static_cast<unsigned>(decoding.shrink);
    info_.out_color_space = decoding.color ? JCS_EXT_BGR : JCS_GRAYSCALE;
    jpeg_start_decompress(&info_);
    return true;
  }

  bool ReadRows(cv::Mat& image) {
    if (setjmp(errors_.escape) != 0) {  // NOLINT(cert-err52-cpp)
      return false;
    }
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = image.ptr(static_cast<int>(info_.output_scanline));
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  cv::Size size() const { return {static_cast<int>(info_.output_width), static_cast<int>(info_.output_height)}; }

 private:
  jpeg_decompress_struct info_{};
  ErrorHandler errors_{};
};

}  // namespace

cv::Mat DecodeJpeg(std::span<const std::uint8_t> bytes, const JpegDecoding& decoding) {
  JpegReader reader;
  if (!reader.Start(bytes, decoding)) {
    return {};
  }
  cv::Mat image(reader.size(), decoding.color ? CV_8UC3 : CV_8UC1);
  return reader.ReadRows(image) ? image : cv::Mat();
}

}  // namespace floorloc
