// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/link.h"

namespace floorloc {

/// True when the share of links with a rival is so high that perceptual aliasing must be expected.
bool IsRepetitiveFloor(const std::vector<Link>& candidates);

/// Minimum agreement of links on a repetitive floor: slightly below what the best link of a typical frame reaches.
/// candidates must not be empty.
double MinAgreement(const std::vector<Link>& candidates);

/// Selects, from links found by appearance, those that join separate parts of a survey and are supported by other
/// links: on repetitive floors false links are rarely consistent with each other, and the frames that they join are
/// less similar than those of true links. Joins the strongest pairs first, many per round (Boruvka), and each round
/// uses the joins of the previous ones. `links` are already trusted.
std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates);

}  // namespace floorloc
