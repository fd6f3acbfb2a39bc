// SPDX-License-Identifier: Apache-2.0
#include "server/wire/problem_json.h"

#include <nlohmann/json.hpp>

#include "server/wire/strict_json.h"

namespace floorloc {

const char* StatusTitle(int status) {
  switch (status) {
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 416:
      return "Range Not Satisfiable";
    case 417:
      return "Expectation Failed";
    case 422:
      return "Unprocessable Content";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 501:
      return "Not Implemented";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    case 507:
      return "Insufficient Storage";
    default:
      return "Error";
  }
}

std::string FormatProblem(const Problem& problem) {
  return ToText({{"type", "about:blank"},
                 {"title", StatusTitle(problem.status())},
                 {"status", problem.status()},
                 {"detail", problem.what()},
                 {"code", problem.code()}});
}

}  // namespace floorloc
