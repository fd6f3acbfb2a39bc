// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace floorloc {

/// Standard base64 with padding (RFC 4648, section 4).
std::string EncodeBase64(std::span<const std::uint8_t> bytes);

/// Bytes of standard base64 with padding (RFC 4648, section 4). Empty when the text is none, line breaks included.
std::optional<std::string> DecodeBase64(std::string_view text);

}  // namespace floorloc
