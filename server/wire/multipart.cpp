// SPDX-License-Identifier: Apache-2.0
#include "server/wire/multipart.h"

#include <algorithm>

#include "server/wire/header_text.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxParts = 16;
constexpr std::size_t kMaxBoundaryBytes = 70;  // RFC 2046, section 5.1.1

Problem Malformed(const std::string& detail) {
  return {400, "malformed_body", "The multipart/form-data body is malformed: " + detail};
}

// Removes the text before a character from the front; all of it when there is none.
std::string_view TakeUntil(std::string_view& rest, std::string_view ends) {
  const std::size_t end = std::min(rest.find_first_of(ends), rest.size());
  const std::string_view taken = rest.substr(0, end);
  rest.remove_prefix(end);
  return taken;
}

void SkipBlanks(std::string_view& rest) { rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size())); }

bool Skip(std::string_view& rest, std::string_view expected) {
  const bool there = rest.starts_with(expected);
  rest.remove_prefix(there ? expected.size() : 0);
  return there;
}

std::optional<std::string> TakeQuoted(std::string_view& rest) {
  std::string text;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i] == '"') {
      rest.remove_prefix(i + 1);
      return text;
    }
    i += rest[i] == '\\' ? 1U : 0U;
    if (i < rest.size()) {
      text.push_back(rest[i]);
    }
  }
  return std::nullopt;
}

// Common clients send boundaries that are no tokens, "--=_1/2" for instance, without quotes.
std::optional<std::string> TakeValue(std::string_view& rest) {
  if (rest.starts_with('"')) {
    return TakeQuoted(rest);
  }
  const std::string_view value = TakeUntil(rest, "; \t\"");
  return value.empty() ? std::nullopt : std::optional(std::string(value));
}

class MultipartParser {
 public:
  MultipartParser(std::string_view body, const std::string& boundary) : rest_(body), delimiter_("\r\n--" + boundary) {}

  std::vector<HttpPart> Parse() {
    SkipPreamble();
    std::vector<HttpPart> parts;
    while (!AtEnd()) {
      if (parts.size() == kMaxParts) {
        throw Problem(400, "invalid_parts", "The body has more than 16 parts.");
      }
      parts.push_back(TakePart());
    }
    return parts;
  }

 private:
  void SkipPreamble() {
    if (Skip(rest_, std::string_view(delimiter_).substr(2))) {
      return;
    }
    const std::size_t start = rest_.find(delimiter_);
    if (start == std::string_view::npos) {
      throw Malformed("its boundary does not occur in it.");
    }
    rest_.remove_prefix(start + delimiter_.size());
  }

  // After a delimiter: is it the last one?
  bool AtEnd() {
    if (rest_.starts_with("--")) {
      return true;
    }
    SkipBlanks(rest_);
    if (!Skip(rest_, "\r\n")) {
      throw Malformed("a boundary is not followed by CR LF.");
    }
    return false;
  }

  HttpPart TakePart() {
    const std::size_t end = rest_.find(delimiter_);
    if (end == std::string_view::npos) {
      throw Malformed("it ends before its last boundary.");
    }
    std::string_view part = rest_.substr(0, end);
    rest_.remove_prefix(end + delimiter_.size());
    HttpPart result;
    ReadHeaders(part, result);
    result.content = part;
    return result;
  }

  static void ReadHeaders(std::string_view& part, HttpPart& result) {
    bool named = false;
    while (!Skip(part, "\r\n")) {
      const std::size_t end = part.find("\r\n");
      const std::size_t colon = part.substr(0, end).find(':');
      if (end == std::string_view::npos || colon == std::string_view::npos || !IsToken(part.substr(0, colon))) {
        throw Malformed("the headers of a part are not NAME: VALUE, followed by an empty line.");
      }
      const std::string name = LowerCase(part.substr(0, colon));
      const std::string_view value = TrimBlanks(part.substr(colon + 1, end - colon - 1));
      part.remove_prefix(end + 2);
      if (name == "content-disposition") {
        if (named) {
          throw Malformed("a part has two headers Content-Disposition.");
        }
        result.name = FormName(value);
        named = true;
      } else if (name == "content-type") {
        result.content_type = value;
      }
    }
    if (!named) {
      throw Malformed("a part has no header 'Content-Disposition: form-data; name=...'.");
    }
  }

  static std::string FormName(std::string_view value) {
    const auto disposition = ParseParameterizedValue(value);
    if (!disposition || disposition->value != "form-data" || !disposition->parameters.contains("name")) {
      throw Malformed("a part has no header 'Content-Disposition: form-data; name=...'.");
    }
    return disposition->parameters.at("name");
  }

  std::string_view rest_;
  std::string delimiter_;
};

}  // namespace

std::optional<ParameterizedValue> ParseParameterizedValue(std::string_view text) {
  ParameterizedValue result;
  result.value = LowerCase(TrimBlanks(TakeUntil(text, ";")));
  while (Skip(text, ";")) {
    SkipBlanks(text);
    if (text.empty() || text.front() == ';') {
      continue;  // an empty parameter is allowed
    }
    const std::string name = LowerCase(TakeUntil(text, "=; \t"));
    if (!IsToken(name) || !Skip(text, "=")) {
      return std::nullopt;
    }
    std::optional<std::string> value = TakeValue(text);
    if (!value || !result.parameters.emplace(name, *std::move(value)).second) {
      return std::nullopt;
    }
    SkipBlanks(text);
  }
  return text.empty() ? std::optional(std::move(result)) : std::nullopt;
}

std::vector<HttpPart> ParseMultipart(std::string_view body, const std::string& content_type) {
  std::optional<ParameterizedValue> type = ParseParameterizedValue(content_type);
  const std::string boundary = type ? type->parameters["boundary"] : "";
  if (boundary.empty() || boundary.size() > kMaxBoundaryBytes) {
    throw Malformed("the header Content-Type has no boundary of 1 to 70 characters.");
  }
  return MultipartParser(body, boundary).Parse();
}

}  // namespace floorloc
