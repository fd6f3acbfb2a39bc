// SPDX-License-Identifier: Apache-2.0
#include "server/wire/names.h"

#include <algorithm>

namespace floorloc {
namespace {

constexpr std::size_t kMaxLength = 64;

bool IsLetterOrDigit(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

bool ConsistsOf(std::string_view text, std::string_view extra) {
  return !text.empty() && text.size() <= kMaxLength && std::all_of(text.begin(), text.end(), [extra](char c) {
    return IsLetterOrDigit(c) || extra.find(c) != std::string_view::npos;
  });
}

}  // namespace

bool IsMapName(std::string_view name) { return ConsistsOf(name, "_-"); }

bool IsVehicleId(std::string_view id) { return id != "." && id != ".." && ConsistsOf(id, "_.-"); }

}  // namespace floorloc
