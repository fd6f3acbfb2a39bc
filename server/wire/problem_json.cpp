// SPDX-License-Identifier: Apache-2.0
#include "server/wire/problem_json.h"

#include <nlohmann/json.hpp>

#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

const char* StatusTitle(int status) {
  switch (status) {
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 416:
      return "Range Not Satisfiable";
    case 422:
      return "Unprocessable Content";
    case 429:
      return "Too Many Requests";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

}  // namespace

std::string FormatProblem(const Problem& problem) {
  return ToText({{"type", "about:blank"},
                 {"title", StatusTitle(problem.status())},
                 {"status", problem.status()},
                 {"detail", problem.what()},
                 {"code", problem.code()}});
}

}  // namespace floorloc
