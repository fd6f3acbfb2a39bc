// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/wire/problem.h"

namespace floorloc {

/// {"type","title","status","detail","code"}
std::string FormatProblem(const Problem& problem);

}  // namespace floorloc
