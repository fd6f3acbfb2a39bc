// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace floorloc {

std::string LowerCase(std::string_view text);
/// Without spaces and tabs at both ends.
std::string_view TrimBlanks(std::string_view text);
/// A token of RFC 9110, section 5.6.2: names of methods, headers and parameters.
bool IsToken(std::string_view text);
/// Is item one of a comma-separated list? Both in lower case.
bool HasListItem(std::string_view list, std::string_view item);

}  // namespace floorloc
