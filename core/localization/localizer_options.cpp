// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer_options.h"

#include <stdexcept>

namespace floorloc {

void LocalizerOptions::Check() const {
  if (!(max_ratio_float > 0.0F && max_ratio_float <= 1.0F) || !(max_ratio_binary > 0.0F && max_ratio_binary <= 1.0F)) {
    throw std::invalid_argument("max_ratio must be above 0 and at most 1");
  }
  if (index.trees < 1 || index.trees > 64 || index.checks < 1 || index.checks > 1000000) {
    throw std::invalid_argument("index trees must be 1 to 64 and checks 1 to 1000000");
  }
  if (!(systematic_m >= 0.0 && systematic_share >= 0.0 && systematic_lever_m > 0.0)) {
    throw std::invalid_argument("systematic_m and systematic_share must not be negative, systematic_lever_m positive");
  }
  search.Check();
  self_similarity.Check();
  registration.Check();
  verification.Check();
  photometric.Check();
  decision.Check();
}

}  // namespace floorloc
