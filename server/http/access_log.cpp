// SPDX-License-Identifier: Apache-2.0
#include "server/http/access_log.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace floorloc {

std::string Printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c <= ' ' || c > '~'; }, '?');
  return text;
}

std::string FormatAccessText(const AccessRecord& record) {
  const auto or_dash = [](const std::string& text) { return text.empty() ? "-" : text; };
  return fmt::format("{} {} \"{} {}\" {} {} {} B {:.1f} ms {}", or_dash(record.remote), or_dash(record.who),
                     Printable(record.method), Printable(record.path), record.status, or_dash(record.problem),
                     record.bytes, 1e3 * record.seconds, record.trace.request_id);
}

std::string FormatAccessJson(const AccessRecord& record) {
  nlohmann::ordered_json json = {{"message", "access"},
                                 {"method", Printable(record.method)},
                                 {"path", Printable(record.path)},
                                 {"route", record.route},
                                 {"status", record.status},
                                 {"bytes", record.bytes},
                                 {"duration_ms", std::round(1e6 * record.seconds) / 1e3},
                                 {"remote", record.remote}};
  if (!record.problem.empty()) {
    json["problem"] = record.problem;
  }
  if (!record.who.empty()) {
    json["who"] = record.who;
  }
  json["request_id"] = record.trace.request_id;
  json["trace_id"] = record.trace.trace_id;
  json["span_id"] = record.trace.span_id;
  const std::string text = json.dump();
  return text.substr(1, text.size() - 2);
}

}  // namespace floorloc
