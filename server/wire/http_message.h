// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/body_sink.h"
#include "server/wire/request_trace.h"

namespace floorloc {

/// One part of a multipart/form-data body.
struct HttpPart {
  std::string name;
  std::string content_type;
  std::string content;
};

/// A decoded request, independent of the HTTP library.
struct HttpRequest {
  std::string method;
  std::string path;  ///< decoded, without the query
  std::multimap<std::string, std::string> query;
  std::map<std::string, std::string> headers;  ///< names in lower case; of repeated headers the first
  std::map<std::string, std::string> path_parameters;
  std::string remote_address;
  std::string body;                ///< empty for multipart/form-data
  std::vector<HttpPart> parts;     ///< of multipart/form-data
  std::shared_ptr<BodySink> sink;  ///< holds the body instead, of calls that stream it
  RequestTrace trace = {};

  /// Value of a header (name in lower case), or "".
  std::string Header(const std::string& name) const;
  /// Media type of the body in lower case, without parameters, or "".
  std::string ContentType() const;
  /// Value of a query parameter. Throws Problem when it occurs more than once.
  std::optional<std::string> QueryValue(const std::string& name) const;
};

struct HttpResponse {
  int status = 200;
  std::string content_type;
  std::string body;
  std::map<std::string, std::string> headers;
  /// Set: the body is not this one, but what is written to the connection from now on. Called when the head was sent;
  /// the socket is open during the call only: make a copy.
  std::function<void(int socket)> take_over = nullptr;
  std::string problem = "";  ///< its code, when the response is a problem
};

}  // namespace floorloc
