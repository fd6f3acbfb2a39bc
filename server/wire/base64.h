// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace floorloc {

/// Bytes of standard base64 with padding (RFC 4648, section 4). Empty when the text is none, line breaks included.
std::optional<std::string> DecodeBase64(std::string_view text);

}  // namespace floorloc
