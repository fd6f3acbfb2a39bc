// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/wire/http_message.h"

namespace floorloc {

/// A header value with parameters: "form-data; name=image; filename=\"a b.jpg\"".
struct ParameterizedValue {
  std::string value;                              ///< in lower case
  std::map<std::string, std::string> parameters;  ///< names in lower case; values without quotes
};

/// RFC 9110, section 5.6.6: parameters in any order, as a token or a quoted string. Empty when it is malformed or names
/// a parameter twice.
std::optional<ParameterizedValue> ParseParameterizedValue(std::string_view text);

/// The parts of a multipart/form-data body (RFC 7578, RFC 2046 section 5.1), at most 16. content_type: the header, with
/// the boundary. Throws Problem 400 malformed_body or invalid_parts.
std::vector<HttpPart> ParseMultipart(std::string_view body, const std::string& content_type);

}  // namespace floorloc
