// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/http_response.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

namespace floorloc {
namespace {

bool EqualsIgnoringCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  const std::size_t end = text.find_last_not_of(" \t");
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, end - begin + 1);
}

}  // namespace

bool HttpResponse::ParseHead() {
  const std::string_view head = std::string_view(bytes_).substr(0, head_size_ - 2);  // lines with their ends
  if (!head.starts_with("HTTP/1.1 ") || head.size() < 12) {
    return false;
  }
  const std::optional<int> status = ParseNumber<int>(head.substr(9, 3));
  std::optional<std::size_t> size;
  for (std::size_t line = head.find("\r\n") + 2; line < head.size();) {
    const std::size_t end = head.find("\r\n", line);
    const std::size_t colon = head.find(':', line);
    if (colon >= end) {
      return false;
    }
    const std::string_view name = head.substr(line, colon - line);
    const std::string_view value = Trimmed(head.substr(colon + 1, end - colon - 1));
    if (EqualsIgnoringCase(name, "content-length")) {
      size = ParseNumber<std::size_t>(value);
    } else if (EqualsIgnoringCase(name, "connection")) {
      closes_ = EqualsIgnoringCase(value, "close");
    }
    line = end + 2;
  }
  if (!status || !size) {
    return false;
  }
  status_ = *status;
  body_size_ = *size;
  return true;
}

HttpResponse::Progress HttpResponse::Add(std::string_view bytes) {
  bytes_ += bytes;
  if (head_size_ == 0) {
    const std::size_t end = bytes_.find("\r\n\r\n");
    if (end == std::string::npos) {
      return Progress::kIncomplete;
    }
    head_size_ = end + 4;
    if (!ParseHead()) {
      return Progress::kMalformed;
    }
  }
  return bytes_.size() < head_size_ + body_size_ ? Progress::kIncomplete : Progress::kWhole;
}

}  // namespace floorloc
