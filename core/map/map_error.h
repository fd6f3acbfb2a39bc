// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace floorloc {

/// A map file is missing, damaged, of an unknown version or can't be written. what() is one sentence that names the
/// file and says what to do.
class MapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace floorloc
