// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer_options.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void LocalizerOptions::Check() const {
  index.Check();
  RequireOption(max_ratio_float > 0.0F && max_ratio_float <= 1.0F, "max_ratio_float must be above 0 and at most 1");
  RequireOption(max_ratio_binary > 0.0F && max_ratio_binary <= 1.0F, "max_ratio_binary must be above 0 and at most 1");
  RequireOption(systematic_m >= 0.0, "systematic_m must not be negative");
  RequireOption(systematic_share >= 0.0, "systematic_share must not be negative");
  RequireOption(systematic_lever_m > 0.0, "systematic_lever_m must be positive");
  search.Check();
  self_similarity.Check();
  lattice.Check();
  lattice_comparison.Check();
  registration.Check();
  verification.Check();
  photometric.Check();
  decision.Check();
  readout.Check();
  readout_fit.Check();
  partial_view.Check();
  motion_blur.Check();
  floor.Check();
}

}  // namespace floorloc
