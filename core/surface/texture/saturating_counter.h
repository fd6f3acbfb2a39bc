// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/surface/texture/texture_classifier.h"

namespace floorloc {

/// Chooses between a fast detector for rough floor and a stable one for smooth floor, by the last images' textures and
/// not by one alone: the n-bit saturating counter of branch prediction (Otsu et al. 2013, section 3.2). Its highest bit
/// chooses.
class SaturatingCounter {
 public:
  /// bits: 1 to 8; one follows each image. Starts with the stable detector, next to the fast one: the article does not
  /// say. Throws std::invalid_argument.
  explicit SaturatingCounter(int bits = 2);

  /// ROUGH counts up, SMOOTH down; an unknown texture and SHADOW, of which the article says nothing, change nothing.
  void Add(TextureClass texture);
  bool ChoosesFast() const { return 2 * state_ > max_; }
  int state() const { return state_; }

 private:
  int max_;
  int state_;
};

}  // namespace floorloc
