// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace floorloc {

/// A finite decimal number and nothing else.
std::optional<double> ParseFinite(std::string_view text);
/// Such numbers between commas; empty when one of them is none.
std::vector<double> ParseNumberList(std::string_view text);

}  // namespace floorloc
