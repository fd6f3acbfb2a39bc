// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/wire/problem.h"

namespace floorloc {

/// "Not Found" for 404.
const char* StatusTitle(int status);

/// {"type","title","status","detail","code"}
std::string FormatProblem(const Problem& problem);

}  // namespace floorloc
