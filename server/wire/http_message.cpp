// SPDX-License-Identifier: Apache-2.0
#include "server/wire/http_message.h"

#include <algorithm>
#include <cctype>

#include "server/wire/problem.h"

namespace floorloc {

std::string HttpRequest::Header(const std::string& name) const {
  const auto it = headers.find(name);
  return it == headers.end() ? "" : it->second;
}

std::string HttpRequest::ContentType() const {
  std::string type = Header("content-type");
  type.resize(std::min(type.find(';'), type.size()));
  while (!type.empty() && std::isspace(static_cast<unsigned char>(type.back())) != 0) {
    type.pop_back();
  }
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return type;
}

std::optional<std::string> HttpRequest::QueryValue(const std::string& name) const {
  const auto [first, last] = query.equal_range(name);
  if (first == last) {
    return std::nullopt;
  }
  if (std::next(first) != last) {
    throw Problem(400, "invalid_parameter", "The query parameter '" + name + "' is given more than once.");
  }
  return first->second;
}

}  // namespace floorloc
