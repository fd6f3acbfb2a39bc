// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace floorloc {

/// Parses a finite decimal number; empty when there is any other text.
std::optional<double> ParseFinite(std::string_view text);
/// Parses comma-separated finite numbers; empty when any of them is invalid.
std::vector<double> ParseNumberList(std::string_view text);

}  // namespace floorloc
