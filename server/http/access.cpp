// SPDX-License-Identifier: Apache-2.0
#include "server/http/access.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <stdexcept>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "server/wire/header_text.h"
#include "server/wire/names.h"

namespace floorloc {
namespace {

constexpr std::size_t kMinTokenLength = 16;
constexpr std::size_t kHashDigits = 64;
constexpr std::uint64_t kMaxTokenFileBytes = std::uint64_t{1} << 20;
constexpr std::array kRoles = {Role::kVehicle, Role::kOperator, Role::kAdmin};

std::string Sha256(const std::string& text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), hash.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL computes no SHA-256.");
  }
  std::string hex;
  for (unsigned i = 0; i < size; ++i) {
    hex += {kDigits[hash[i] >> 4U], kDigits[hash[i] & 15U]};
  }
  return hex;
}

bool IsTokenCharacter(char c) { return std::isgraph(static_cast<unsigned char>(c)) != 0; }

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> items;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, separator);) {
    items.push_back(item);
  }
  return items;
}

bool IsIdPattern(const std::string& id) {
  return id == "*" || IsVehicleId(id.ends_with('*') ? id.substr(0, id.size() - 1) : id);
}

Role ParseRole(const std::string& text) {
  const auto found = std::find_if(kRoles.begin(), kRoles.end(), [&](Role role) { return ToString(role) == text; });
  if (found == kRoles.end()) {
    throw std::invalid_argument("the role must be vehicle, operator or admin");
  }
  return *found;
}

Principal ParsePrincipal(const std::string& name, const std::string& role, const std::string& ids) {
  Principal principal{name, ParseRole(role), Split(ids, ',')};
  if (!IsVehicleId(name)) {
    throw std::invalid_argument("the name must have letters, digits, '_', '.' and '-'");
  }
  if ((principal.role == Role::kVehicle) == principal.ids.empty() ||
      !std::all_of(principal.ids.begin(), principal.ids.end(), IsIdPattern)) {
    throw std::invalid_argument("a vehicle, and nobody else, has ids: agv1,agv2 or agv*");
  }
  return principal;
}

void CheckOwner(const std::filesystem::path& file) {
  using std::filesystem::perms;
  std::error_code error;
  const perms mode = std::filesystem::status(file, error).permissions();
  if (!error && mode != perms::unknown && (mode & (perms::group_all | perms::others_all)) != perms::none) {
    throw InputError(file, "the token can be read by other users; run chmod 600 on it");
  }
}

AccessTokens SingleToken(const std::filesystem::path& file, const std::string& token) {
  if (token.size() < kMinTokenLength) {
    throw InputError(file, "the token is shorter than 16 characters; write a random one, e.g. openssl rand -hex 24");
  }
  if (!std::all_of(token.begin(), token.end(), IsTokenCharacter)) {
    throw InputError(file, "the token must be one line of printable characters without spaces");
  }
  return AccessTokens(token);
}

}  // namespace

const char* ToString(Role role) {
  return role == Role::kVehicle ? "vehicle" : role == Role::kOperator ? "operator" : "admin";
}

bool Principal::MayChangeVehicle(const std::string& id) const {
  return role != Role::kVehicle || std::any_of(ids.begin(), ids.end(), [&id](const std::string& own) {
           return own.ends_with('*') ? id.starts_with(std::string_view(own).substr(0, own.size() - 1)) : id == own;
         });
}

AccessTokens::AccessTokens(const std::string& token) {
  entries_.push_back({{"token", Role::kAdmin, {}}, Sha256(token)});
}

std::size_t AccessTokens::CountOf(Role role) const {
  return static_cast<std::size_t>(std::count_if(entries_.begin(), entries_.end(),
                                                [role](const Entry& entry) { return entry.principal.role == role; }));
}

// What the time of the comparisons tells is about the hash of what was sent, and of no use to who sent it.
const Principal* AccessTokens::Find(const std::string& authorization) const {
  static const std::string kScheme = "Bearer ";
  if (!authorization.starts_with(kScheme)) {
    return nullptr;
  }
  const std::string sha256 = Sha256(authorization.substr(kScheme.size()));
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.sha256 == sha256; });
  return found == entries_.end() ? nullptr : &found->principal;
}

void AccessTokens::AddLine(const std::string& line) {
  std::istringstream words(line);
  std::string name;
  std::string role;
  std::string sha256;
  std::string ids;
  std::string rest;
  words >> name >> role >> sha256 >> ids >> rest;
  sha256 = LowerCase(sha256);
  if (sha256.size() != kHashDigits || sha256.find_first_not_of("0123456789abcdef") != std::string::npos ||
      !rest.empty()) {
    throw std::invalid_argument("a line is NAME ROLE SHA256 [IDS], the hash as sha256sum prints it");
  }
  Principal principal = ParsePrincipal(name, role, ids);
  for (const Entry& entry : entries_) {
    if (entry.sha256 == sha256 || entry.principal.name == name) {
      throw std::invalid_argument("the name or the token is that of an earlier line");
    }
  }
  entries_.push_back({std::move(principal), std::move(sha256)});
}

AccessTokens ParseTokens(const std::string& whole_text, const std::filesystem::path& source) {
  std::string text = whole_text;
  std::erase(text, '\r');
  while (!text.empty() && !IsTokenCharacter(text.back())) {
    text.pop_back();
  }
  const std::vector<std::string> lines = Split(text, '\n');
  if (lines.size() <= 1 && text.find(' ') == std::string::npos) {
    return SingleToken(source, text);
  }
  AccessTokens tokens;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = TrimBlanks(lines[i]);
    if (line.empty() || line.front() == '#') {
      continue;
    }
    try {
      tokens.AddLine(std::string(line));
    } catch (const std::invalid_argument& error) {
      throw InputError(source, static_cast<int>(i + 1), error.what());
    }
  }
  if (tokens.empty()) {
    throw InputError(source, "there is no token in it");
  }
  return tokens;
}

AccessTokens ReadTokenFile(const std::filesystem::path& file) {
  CheckOwner(file);
  return ParseTokens(ReadTextFile(file, kMaxTokenFileBytes), file);
}

}  // namespace floorloc
