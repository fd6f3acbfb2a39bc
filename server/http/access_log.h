// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "server/wire/request_trace.h"

namespace floorloc {

/// One request and its answer, for the access log. Tokens and queries are not part of it.
struct AccessRecord {
  std::string method;
  std::string path;   ///< as it came
  std::string route;  ///< pattern of the path, "unmatched" for one that is not served
  int status = 0;
  std::string problem;    ///< code of the problem; empty: answered
  std::size_t bytes = 0;  ///< of the answer's body
  double seconds = 0.0;   ///< from the complete request to the answer; 0: refused before its body was read
  std::string remote;     ///< address
  std::string who;        ///< name of the token; empty: none, or one that is not known
  RequestTrace trace;
};

using AccessLog = std::function<void(const AccessRecord&)>;

/// 10.0.0.7 line-3 "POST /v1/vehicles/agv7/frames" 200 - 512 B 12.3 ms 4bf92f3577b34da6
std::string FormatAccessText(const AccessRecord& record);
/// Members of a JSON object, without its braces.
std::string FormatAccessJson(const AccessRecord& record);

/// A line of a log is one line: other than printable ASCII becomes a question mark.
std::string Printable(std::string text);

}  // namespace floorloc
