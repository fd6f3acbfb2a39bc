// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace floorloc {

enum class Role {
  kVehicle,   ///< changes its own vehicles only
  kOperator,  ///< changes all vehicles
  kAdmin,     ///< may do everything
};
const char* ToString(Role role);

/// Whom a token belongs to.
struct Principal {
  std::string name;
  Role role = Role::kAdmin;
  std::vector<std::string> ids;  ///< of Role::kVehicle: ids, or with a star at the end beginnings of ids

  bool MayChangeVehicle(const std::string& id) const;
};

/// The bearer tokens that the server knows, as SHA-256. Never printed.
class AccessTokens {
 public:
  /// Without tokens everything is allowed.
  AccessTokens() = default;
  /// One token for everything.
  explicit AccessTokens(const std::string& token);

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  std::size_t CountOf(Role role) const;
  /// authorization: value of the Authorization header, "Bearer TOKEN". Null for a token that is not known.
  const Principal* Find(const std::string& authorization) const;

 private:
  friend AccessTokens ParseTokens(const std::string& text, const std::filesystem::path& source);

  struct Entry {
    Principal principal;
    std::string sha256;  // of the token, 64 hex digits in lower case
  };
  void AddLine(const std::string& line);

  std::vector<Entry> entries_;
};

/// Parses one token of at least 16 characters, or lines "NAME ROLE SHA256 [ID,ID*,...]" with the ids of a vehicle's
/// token; empty lines and those that begin with # are skipped. source: for messages. Throws InputError.
AccessTokens ParseTokens(const std::string& text, const std::filesystem::path& source);

/// The same from a file that only its owner may read. Throws InputError.
AccessTokens ReadTokenFile(const std::filesystem::path& file);

}  // namespace floorloc
