// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <opencv2/core/mat.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace floorloc {

/// Serialises values in native layout, since a journal is only read by the program that wrote it.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T> ByteWriter& Add(const T& value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
    return *this;
  }
  template <typename T>
  requires std::is_trivially_copyable_v<T> ByteWriter& Add(const std::vector<T>& values) {
    Add(static_cast<std::uint64_t>(values.size()));
    const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), first, first + values.size() * sizeof(T));
    return *this;
  }
  ByteWriter& Add(const std::string& text) { return Add(std::vector<char>(text.begin(), text.end())); }
  ByteWriter& Add(const cv::Mat& mat) {
    const cv::Mat packed = mat.isContinuous() ? mat : mat.clone();
    Add(packed.rows).Add(packed.cols).Add(packed.type());
    return Add(std::vector<std::uint8_t>(packed.data, packed.data + packed.total() * packed.elemSize()));
  }

  std::vector<std::uint8_t> Take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Deserialises in the same order. After an attempt to read past the end all values are empty and Complete() is false.
class ByteReader {
 public:
  explicit ByteReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void Read(T* value) {
    if (Has(sizeof(T))) {
      std::memcpy(value, bytes_.data() + at_, sizeof(T));
      at_ += sizeof(T);
    }
  }
  void Read(bool* value) {
    std::uint8_t byte = 0;
    Read(&byte);
    failed_ = failed_ || byte > 1;  // other values are invalid
    *value = byte == 1;
  }
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void Read(std::vector<T>* values) {
    std::uint64_t count = 0;
    Read(&count);
    if (count > bytes_.size() || !Has(count * sizeof(T))) {
      failed_ = true;
      return;
    }
    values->resize(count);
    if (count > 0) {
      std::memcpy(values->data(), bytes_.data() + at_, count * sizeof(T));
    }
    at_ += count * sizeof(T);
  }
  void Read(std::string* text) {
    std::vector<char> characters;
    Read(&characters);
    text->assign(characters.begin(), characters.end());
  }
  void Read(cv::Mat* mat) {
    int rows = 0;
    int cols = 0;
    int type = 0;
    std::vector<std::uint8_t> pixels;
    Read(&rows);
    Read(&cols);
    Read(&type);
    Read(&pixels);
    if (failed_ || !Fits(rows, cols, type, pixels.size())) {
      failed_ = true;
      return;
    }
    mat->create(rows, cols, type);
    if (!pixels.empty()) {
      std::memcpy(mat->data, pixels.data(), pixels.size());
    }
  }

  bool failed() const { return failed_; }
  /// True when everything was read and nothing is left.
  bool Complete() const { return !failed_ && at_ == bytes_.size(); }

 private:
  // Divides, since the product of untrusted numbers could overflow.
  static bool Fits(int rows, int cols, int type, std::size_t bytes) {
    if (rows < 0 || cols < 0 || CV_MAT_TYPE(type) != type) {
      return false;
    }
    const std::size_t row_bytes = static_cast<std::size_t>(cols) * static_cast<std::size_t>(CV_ELEM_SIZE(type));
    return rows == 0 || row_bytes == 0 ? bytes == 0
                                       : bytes / row_bytes == static_cast<std::size_t>(rows) && bytes % row_bytes == 0;
  }
  bool Has(std::size_t count) {
    failed_ = failed_ || count > bytes_.size() - at_;
    return !failed_;
  }

  const std::vector<std::uint8_t>& bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace floorloc
