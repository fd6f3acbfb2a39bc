// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/pair_registration.h"

namespace floorloc {

/// Of links found by appearance, those that join separate parts of a survey and are borne out by others: on repeating
/// floors single links lie, but they do not lie consistently. The strongest join goes first; what it settles counts for
/// the next. `links` are trusted already.
std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates);

}  // namespace floorloc
