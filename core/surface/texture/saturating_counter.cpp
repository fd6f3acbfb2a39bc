// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/saturating_counter.h"

#include <algorithm>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

int States(int bits) {
  RequireOption(bits >= 1 && bits <= 8, "bits must be 1 to 8");
  return 1 << bits;
}

}  // namespace

SaturatingCounter::SaturatingCounter(int bits) : max_(States(bits) - 1), state_(max_ / 2) {}

void SaturatingCounter::Add(TextureClass texture) {
  if (texture == TextureClass::kRough) {
    state_ = std::min(state_ + 1, max_);
  } else if (texture == TextureClass::kSmooth) {
    state_ = std::max(state_ - 1, 0);
  }
}

}  // namespace floorloc
