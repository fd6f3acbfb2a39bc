// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/registration/registration.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

struct LocalizerOptions {
  IndexOptions index;              ///< of the global search
  float max_ratio_float = 0.85F;   ///< ratio test, float descriptors
  float max_ratio_binary = 0.90F;  ///< ratio test, binary descriptors
  RegistrationOptions registration;
  double systematic_m = 2e-4;     ///< error of the map that a frame's residuals do not show
  double systematic_share = 1.0;  ///< the same as a share of their RMS, where the mosaic was not compared
  std::size_t mosaic_memory_bytes = std::size_t{128} << 20;  ///< of the decoded mosaic that is kept

  void Check() const;
};

}  // namespace floorloc
