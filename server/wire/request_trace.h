// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace floorloc {

/// What ties the log lines of a request together, and the request to those of other services (W3C Trace Context).
struct RequestTrace {
  std::string request_id;    ///< header X-Request-Id, else the span's
  std::string trace_id;      ///< 32 hex digits: those of the header traceparent, else made up
  std::string span_id;       ///< 16 hex digits: this request's within the trace, made up
  std::string flags = "00";  ///< of the header
  bool continued = false;    ///< the request had a traceparent

  /// "00-TRACE_ID-SPAN_ID-FLAGS"
  std::string Traceparent() const;
};

/// headers: names in lower case. A malformed traceparent, and an X-Request-Id that has other than 1 to 128 letters,
/// digits and "-_.:/+=", are ignored.
RequestTrace StartTrace(const std::map<std::string, std::string>& headers);

}  // namespace floorloc
