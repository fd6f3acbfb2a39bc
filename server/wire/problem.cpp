// SPDX-License-Identifier: Apache-2.0
#include "server/wire/problem.h"

#include <map>

#include "server/wire/problem_json.h"

namespace floorloc {

HttpResponse ToResponse(const Problem& problem) {
  HttpResponse response;
  response.status = problem.status();
  response.problem = problem.code();
  response.content_type = "application/problem+json";
  response.body = FormatProblem(problem);
  response.headers["Cache-Control"] = "no-store";
  if (problem.retry() == Problem::Retry::kSoon) {
    response.headers["Retry-After"] = std::to_string(problem.retry_after_s());
  }
  if (problem.status() == 401) {
    response.headers["WWW-Authenticate"] = "Bearer";
  }
  return response;
}

Problem ProblemOfStatus(int status) {
  switch (status) {
    case 404:
      return Problem(404, "not_found", "Nothing is served at this path; /openapi.yaml lists the calls.");
    case 408:
      return Problem(408, "request_timeout", "The request did not arrive in time; send it at once.");
    case 413:
      return Problem(413, "body_too_large", "The body is larger than this server accepts.");
    case 414:
      return Problem(414, "uri_too_long", "The request line is too long.");
    case 415:
      return Problem(415, "unsupported_encoding", "The body has a Content-Encoding that this server does not read.");
    case 416:
      return Problem(416, "invalid_range", "The Range header is malformed; this server does not need one.");
    default:
      return Problem(status, status < 500 ? "malformed_request" : "internal_error",
                     status < 500 ? "The request is not well-formed HTTP." : "The server failed to answer.");
  }
}

}  // namespace floorloc
