// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace floorloc {
namespace {

struct BadValue {
  std::string field;
  std::function<void(LocalizerOptions*)> set;
};

const double kNan = std::nan("");

std::vector<BadValue> BadSearchValues() {
  return {{"votes_per_keypoint", [](auto* o) { o->search.votes_per_keypoint = 0; }},
          {"max_vote_distance", [](auto* o) { o->search.max_vote_distance = std::nanf(""); }},
          {"prior_failure_rate", [](auto* o) { o->search.prior_failure_rate = 0.0; }},
          {"min_rival_share", [](auto* o) { o->search.min_rival_share = 1.5; }},
          {"clear_log10_nfa", [](auto* o) { o->search.clear_log10_nfa = 1.0; }},
          {"sample", [](auto* o) { o->self_similarity.sample = 0; }},
          {"neighbours", [](auto* o) { o->self_similarity.neighbours = 0; }},
          {"min_distance_m", [](auto* o) { o->self_similarity.min_distance_m = kNan; }},
          {"max_bit_share", [](auto* o) { o->self_similarity.max_bit_share = 1.0; }},
          {"min_duplicate_share", [](auto* o) { o->self_similarity.min_duplicate_share = 0.0; }}};
}

std::vector<BadValue> BadLatticeValues() {
  return {{"copies", [](auto* o) { o->lattice.copies = 0; }},
          {"max_angle_rad", [](auto* o) { o->lattice.max_angle_rad = kNan; }},
          {"max_period_m", [](auto* o) { o->lattice.max_period_m = 0.01; }},
          {"bin_m", [](auto* o) { o->lattice.bin_m = 0.0; }},
          {"reach_m", [](auto* o) { o->lattice.reach_m = 1.0; }},
          {"min_peak_share", [](auto* o) { o->lattice.min_peak_share = 1.5; }},
          {"tolerance_m", [](auto* o) { o->lattice.tolerance_m = 0.0; }},
          {"min_share", [](auto* o) { o->lattice.min_share = 0.0; }},
          {"max_places", [](auto* o) { o->lattice_comparison.max_places = 5; }},
          {"typical_places", [](auto* o) { o->lattice_comparison.typical_places = 5; }},
          {"max_poses", [](auto* o) { o->lattice_comparison.max_poses = 0; }},
          {"min_known_share", [](auto* o) { o->lattice_comparison.min_known_share = 0.0; }},
          {"min_places", [](auto* o) { o->lattice_comparison.min_places = 1; }},
          {"temper", [](auto* o) { o->lattice_comparison.temper = 2.0; }},
          {"max_sigma", [](auto* o) { o->lattice_comparison.max_sigma = kNan; }}};
}

std::vector<BadValue> BadVerificationValues() {
  return {{"search_radii", [](auto* o) { o->verification.search_radii = 0.5; }},
          {"yaw_radius_rad", [](auto* o) { o->verification.yaw_radius_rad = kNan; }},
          {"alike_share", [](auto* o) { o->verification.alike_share = 0.0; }},
          {"min_neighbour_radii", [](auto* o) { o->verification.min_neighbour_radii = 30.0; }},
          {"max_neighbour_radii", [](auto* o) { o->verification.max_neighbour_radii = 1e4; }},
          {"copies_sigma", [](auto* o) { o->verification.copies_sigma = kNan; }},
          {"min_chance", [](auto* o) { o->verification.min_chance = 0.9; }},
          {"max_chance", [](auto* o) { o->verification.max_chance = 1.0; }},
          {"min_cell_samples", [](auto* o) { o->photometric.min_cell_samples = 0; }},
          {"min_correlation", [](auto* o) { o->photometric.min_correlation = 1.0; }},
          {"max_correction_radii", [](auto* o) { o->photometric.max_correction_radii = 0.0; }}};
}

std::vector<BadValue> BadDecisionValues() {
  return {{"structure_exponent", [](auto* o) { o->decision.structure_exponent = 0.0; }},
          {"cell_sigma", [](auto* o) { o->decision.cell_sigma = kNan; }},
          {"trimmed_share", [](auto* o) { o->decision.trimmed_share = 1.1; }},
          {"max_correlation", [](auto* o) { o->decision.max_correlation = 1.0; }},
          {"distinctive_share", [](auto* o) { o->decision.distinctive_share = 0.0; }},
          {"local_share", [](auto* o) { o->decision.local_share = 1.0; }},
          {"look_alike_taken", [](auto* o) { o->decision.look_alike_taken = -0.1; }},
          {"clear_p_wrong", [](auto* o) { o->decision.clear_p_wrong = 2.0; }},
          {"min_p_wrong", [](auto* o) { o->registration.min_p_wrong = 1.0; }},
          {"max_rival_log10_nfa", [](auto* o) { o->registration.max_rival_log10_nfa = kNan; }},
          {"inlier_independence", [](auto* o) { o->registration.inlier_independence = 0.0; }},
          {"systematic_lever_m", [](auto* o) { o->systematic_lever_m = 0.0; }},
          {"max_ratio_binary", [](auto* o) { o->max_ratio_binary = 1.5F; }}};
}

TEST(LocalizerOptionsTest, TheDefaultsAreValid) { EXPECT_NO_THROW(LocalizerOptions().Check()); }

TEST(LocalizerOptionsTest, ABadValueIsNamed) {
  for (const auto& values : {BadSearchValues(), BadLatticeValues(), BadVerificationValues(), BadDecisionValues()}) {
    for (const BadValue& bad : values) {
      LocalizerOptions options;
      bad.set(&options);
      try {
        options.Check();
        ADD_FAILURE() << bad.field << " was accepted";
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(bad.field), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace floorloc
