// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace floorloc {

/// A map file is missing, damaged, of an unknown version or can't be written. what() is one sentence that names the
/// file and says what to do.
class MapError : public std::runtime_error {
 public:
  enum class Kind {
    kOther,        ///< missing, not readable, not writable, or unsuitable for the request
    kDamaged,      ///< not a map, or inconsistent content; retrying does not help
    kUnsupported,  ///< intact, but needs another version of this program
  };

  explicit MapError(const std::string& what, Kind kind = Kind::kOther) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace floorloc
