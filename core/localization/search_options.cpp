// SPDX-License-Identifier: Apache-2.0
#include "core/localization/search_options.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void SearchOptions::Check() const {
  RequireOption(votes_per_keypoint >= 1 && votes_per_keypoint <= 100, "votes_per_keypoint must be 1 to 100");
  RequireOption(max_vote_distance >= 0.0F, "max_vote_distance must not be negative");
  RequireOption(prior_failure_rate > 0.0 && prior_failure_rate < 1.0, "prior_failure_rate must be between 0 and 1");
  RequireOption(unquestioned_p_elsewhere >= 0.0 && unquestioned_p_elsewhere < 1.0,
                "unquestioned_p_elsewhere must be at least 0 and below 1");
  RequireOption(min_rival_share >= 0.0 && min_rival_share <= 1.0, "min_rival_share must be 0 to 1");
  RequireOption(poor_jpeg_quality >= 0 && poor_jpeg_quality <= 100, "poor_jpeg_quality must be 0 (none) to 100");
  RequireOption(thorough_votes >= 1 && thorough_votes <= 100, "thorough_votes must be 1 to 100");
  RequireOption(thorough_vote_distance >= 0.0F, "thorough_vote_distance must not be negative");
  RequireOption(thorough_candidates >= 1 && thorough_candidates <= 1000, "thorough_candidates must be 1 to 1000");
  RequireOption(heading_step_rad > 0.01 && heading_step_rad < 2.0, "heading_step_rad must be 0.01 to 2 rad");
  RequireOption(heading_keypoints >= 1 && heading_keypoints <= 100000, "heading_keypoints must be 1 to 100000");
  RequireOption(thorough_heading_keypoints >= 1 && thorough_heading_keypoints <= 100000,
                "thorough_heading_keypoints must be 1 to 100000");
  RequireOption(thorough_heading_votes >= 1 && thorough_heading_votes <= 100,
                "thorough_heading_votes must be 1 to 100");
  RequireOption(thorough_heading_distance >= 0.0F, "thorough_heading_distance must not be negative");
  RequireOption(modulo_keypoints >= 1 && modulo_keypoints <= 100000, "modulo_keypoints must be 1 to 100000");
  RequireOption(modulo_votes >= 1 && modulo_votes <= 100, "modulo_votes must be 1 to 100");
  RequireOption(modulo_distance >= 0.0F, "modulo_distance must not be negative");
  RequireOption(modulo_candidates >= 1 && modulo_candidates <= 1000, "modulo_candidates must be 1 to 1000");
  RequireOption(clear_log10_nfa <= 0.0, "clear_log10_nfa must not be positive");
}

}  // namespace floorloc
