// SPDX-License-Identifier: Apache-2.0
#include "server/wire/request_trace.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace floorloc {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::size_t kTraceDigits = 32;
constexpr std::size_t kSpanDigits = 16;
constexpr std::size_t kTraceparentLength = 55;
constexpr std::size_t kMaxRequestId = 128;

std::string RandomDigits() {
  std::array<unsigned char, (kTraceDigits + kSpanDigits) / 2> bytes{};
  [[maybe_unused]] const ssize_t count = ::getrandom(bytes.data(), bytes.size(), 0);  // never fails for 24 bytes
  std::string text;
  for (const unsigned char byte : bytes) {
    text += {kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return text;
}

bool IsHex(std::string_view text) { return text.find_first_not_of(kDigits) == std::string_view::npos; }

bool IsId(std::string_view text) { return IsHex(text) && text.find_first_not_of('0') != std::string_view::npos; }

// https://www.w3.org/TR/trace-context/#traceparent-header: a later version may have more at the end.
bool IsTraceparent(std::string_view text) {
  if (text.size() < kTraceparentLength || text[2] != '-' || text[35] != '-' || text[52] != '-') {
    return false;
  }
  const std::string_view version = text.substr(0, 2);
  const bool has_right_end = text.size() == kTraceparentLength || (version != "00" && text[kTraceparentLength] == '-');
  return IsHex(version) && version != "ff" && has_right_end && IsId(text.substr(3, kTraceDigits)) &&
         IsId(text.substr(36, kSpanDigits)) && IsHex(text.substr(53, 2));
}

bool IsRequestId(std::string_view text) {
  static constexpr std::string_view kOthers = "-_.:/+=";
  return !text.empty() && text.size() <= kMaxRequestId && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           kOthers.find(c) != std::string_view::npos;
  });
}

std::string HeaderOf(const std::map<std::string, std::string>& headers, const char* name) {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

}  // namespace

std::string RequestTrace::Traceparent() const { return "00-" + trace_id + "-" + span_id + "-" + flags; }

RequestTrace StartTrace(const std::map<std::string, std::string>& headers) {
  const std::string digits = RandomDigits();
  RequestTrace trace;
  trace.trace_id = digits.substr(0, kTraceDigits);
  trace.span_id = digits.substr(kTraceDigits);
  const std::string parent = HeaderOf(headers, "traceparent");
  if (IsTraceparent(parent)) {
    trace.trace_id = parent.substr(3, kTraceDigits);
    trace.flags = parent.substr(53, 2);
    trace.continued = true;
  }
  const std::string request_id = HeaderOf(headers, "x-request-id");
  trace.request_id = IsRequestId(request_id) ? request_id : trace.span_id;
  return trace;
}

}  // namespace floorloc
