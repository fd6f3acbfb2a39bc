// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace floorloc {

/// The bearer token required for changes. Compared in constant time and never printed.
class AccessToken {
 public:
  /// Without a token everything is allowed.
  AccessToken() = default;
  explicit AccessToken(std::string token) : token_(std::move(token)) {}

  bool empty() const { return token_.empty(); }
  /// authorization: value of the Authorization header, "Bearer TOKEN".
  bool Allows(const std::string& authorization) const;

 private:
  std::string token_;
};

/// Reads a token of at least 16 characters from a file that only its owner may read. Throws InputError.
AccessToken ReadTokenFile(const std::filesystem::path& file);

}  // namespace floorloc
