// SPDX-License-Identifier: Apache-2.0
#include "server/wire/request_head.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <string>

#include "server/wire/header_text.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

// Of these a second one makes two readers of the same head disagree.
constexpr std::array<std::string_view, 7> kSingleHeaders = {
    "host", "content-length", "transfer-encoding", "content-type", "content-encoding", "authorization", "expect"};
constexpr std::array<std::string_view, 8> kMethods = {"GET",    "HEAD",    "POST",  "PUT",
                                                      "DELETE", "OPTIONS", "TRACE", "PATCH"};

Problem Malformed(const std::string& detail) { return {400, "malformed_request", detail}; }

bool IsVisible(char c) { return c >= 0x21 && c <= 0x7E; }
bool IsFieldCharacter(char c) { return c == '\t' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F); }
bool IsHostCharacter(char c) {
  return IsVisible(c) && std::string_view("\"#/<>?@\\^`{|},").find(c) == std::string_view::npos;
}

template <typename Container>
bool Contains(const Container& container, std::string_view text) {
  return std::find(container.begin(), container.end(), text) != container.end();
}

// The line before the next CR LF, which is removed with it.
std::string_view TakeLine(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  if (end == std::string_view::npos || end == 0 || rest[end - 1] != '\r') {
    throw Malformed("A line of the head does not end with CR LF.");
  }
  const std::string_view line = rest.substr(0, end - 1);
  rest.remove_prefix(end + 1);
  return line;
}

class HeadParser {
 public:
  RequestHead Parse(std::string_view rest) {
    const std::string_view line = TakeLine(rest);
    if (line.size() > kMaxRequestLineBytes) {
      throw ProblemOfStatus(414);
    }
    ReadRequestLine(line);
    for (std::string_view header = TakeLine(rest); !header.empty(); header = TakeLine(rest)) {
      ReadHeader(header);
    }
    if (!rest.empty()) {
      throw Malformed("The head goes on after its empty line.");
    }
    Finish();
    return head_;
  }

 private:
  void ReadRequestLine(std::string_view line) {
    const std::size_t first = line.find(' ');
    const std::size_t last = line.rfind(' ');
    if (first == std::string_view::npos || last <= first) {
      throw Malformed("The request line is not METHOD PATH HTTP/1.1.");
    }
    method_ = line.substr(0, first);
    const std::string_view target = line.substr(first + 1, last - first - 1);
    const std::string_view version = line.substr(last + 1);
    if (!IsToken(method_) || target.empty() || !std::all_of(target.begin(), target.end(), IsVisible)) {
      throw Malformed("The request line has a character that must be percent-encoded, or an extra space.");
    }
    if (version != "HTTP/1.1" && version != "HTTP/1.0") {
      if (version.starts_with("HTTP/")) {
        throw Problem(505, "unsupported_http_version", "This server speaks HTTP/1.1.");
      }
      throw Malformed("The request line is not METHOD PATH HTTP/1.1.");
    }
    if (!Contains(kMethods, method_)) {
      throw Problem(501, "unknown_method", "This server does not know this method; methods are in upper case.");
    }
    is_1_0_ = version == "HTTP/1.0";
    head_.keep_alive = !is_1_0_;
  }

  void ReadHeader(std::string_view line) {
    if (line.size() > kMaxHeaderLineBytes || ++headers_ > kMaxHeaders) {
      throw Problem(431, "head_too_large", "A header has more than 8 KiB, or there are more than 100 of them.");
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || !IsToken(line.substr(0, colon))) {
      throw Malformed("A header is not NAME: VALUE, without a space before the colon or a continued line.");
    }
    if (!std::all_of(line.begin(), line.end(), IsFieldCharacter)) {
      throw Malformed("A header has a control character.");
    }
    ReadField(LowerCase(line.substr(0, colon)), TrimBlanks(line.substr(colon + 1)));
  }

  void ReadField(const std::string& name, std::string_view value) {
    if (Contains(kSingleHeaders, name) && !seen_.insert(name).second) {
      throw Malformed("The header " + name + " is given more than once.");
    }
    if (name == "host" && !std::all_of(value.begin(), value.end(), IsHostCharacter)) {
      throw Malformed("The header Host is not a host name with an optional port.");
    }
    if (name == "content-length") {
      ReadLength(value);
    } else if (name == "transfer-encoding") {
      ReadTransferCoding(value);
    } else if (name == "connection") {
      ReadConnection(LowerCase(value));
    } else if (name == "expect") {
      ReadExpectation(LowerCase(value));
    }
  }

  void ReadLength(std::string_view value) {
    const char* end = value.data() + value.size();
    const auto parsed = std::from_chars(value.data(), end, head_.content_length);
    if (parsed.ec == std::errc::result_out_of_range) {
      throw ProblemOfStatus(413);
    }
    if (parsed.ec != std::errc() || parsed.ptr != end) {
      throw Malformed("Content-Length must be one whole number.");
    }
    head_.framing = BodyFraming::kLength;
  }

  void ReadTransferCoding(std::string_view value) const {
    if (is_1_0_) {
      throw Malformed("HTTP/1.0 has no Transfer-Encoding.");
    }
    if (LowerCase(value) != "chunked") {
      throw Problem(501, "unknown_transfer_coding", "This server reads no Transfer-Encoding but chunked.");
    }
  }

  void ReadConnection(const std::string& options) {
    if (HasListItem(options, "close")) {
      close_ = true;
    } else if (HasListItem(options, "keep-alive")) {
      head_.keep_alive = true;
    }
  }

  void ReadExpectation(const std::string& value) {
    if (value != "100-continue") {
      throw Problem(417, "expectation_failed", "This server knows no expectation but 100-continue.");
    }
    head_.expects_continue = !is_1_0_;
  }

  void Finish() {
    if (!is_1_0_ && !seen_.contains("host")) {
      throw Malformed("The header Host is missing.");
    }
    head_.keep_alive = head_.keep_alive && !close_;
    if (seen_.contains("transfer-encoding")) {
      if (head_.framing == BodyFraming::kLength) {
        throw Malformed("A request has either Content-Length or Transfer-Encoding, not both.");
      }
      head_.framing = BodyFraming::kChunked;
    }
  }

  RequestHead head_;
  std::string_view method_;
  std::set<std::string> seen_;  // in lower case
  std::size_t headers_ = 0;
  bool is_1_0_ = false;
  bool close_ = false;
};

}  // namespace

std::optional<std::size_t> HeadScanner::FindEnd(std::string_view bytes) {
  for (; scanned_ < bytes.size(); ++scanned_) {
    const char c = bytes[scanned_];
    if (c == '\n') {
      const std::string_view line = bytes.substr(0, scanned_);
      if (line.ends_with("\n\r") || line.ends_with('\n')) {
        return scanned_ + 1;
      }
    } else if (c != '\r' && !IsFieldCharacter(c)) {
      return bytes.size();
    }
  }
  return std::nullopt;
}

RequestHead ParseRequestHead(std::string_view head) { return HeadParser().Parse(head); }

void ThrowHeadTooLarge(std::string_view begin) {
  if (begin.find('\n') == std::string_view::npos) {
    throw ProblemOfStatus(414);
  }
  throw Problem(431, "head_too_large", "The head of the request is larger than 32 KiB.");
}

}  // namespace floorloc
