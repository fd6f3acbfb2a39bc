// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/link.h"

namespace floorloc {

/// True when so many of the links have a rival that perceptual aliasing must be expected.
bool IsRepetitiveFloor(const std::vector<Link>& candidates);

/// The agreement from which on links are accepted on a repetitive floor: nearly what the best link of every frame
/// reaches. There must be candidates.
double MinAgreement(const std::vector<Link>& candidates);

/// Of links found by appearance, those that join separate parts of a survey and are borne out by others: on repeating
/// floors single links are wrong, but not consistently, and the frames that they join are less similar than those
/// of true links. Parts grow from the strongest joins on, many at a time (Boruvka's rounds); what is joined counts for
/// the next round. `links` are trusted already.
std::vector<Link> FindJoiningLinks(int frame_count, const std::vector<Link>& links,
                                   const std::vector<Link>& candidates);

}  // namespace floorloc
