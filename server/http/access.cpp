// SPDX-License-Identifier: Apache-2.0
#include "server/http/access.h"

#include <cctype>

#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr std::size_t kMinTokenLength = 16;
constexpr std::uint64_t kMaxTokenFileBytes = 4096;

// The run time depends only on the length of `sent`, so that it reveals nothing about the secret.
bool EqualInConstantTime(const std::string& secret, const std::string& sent) {
  unsigned difference = secret.size() == sent.size() ? 0U : 1U;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto a = static_cast<unsigned char>(secret[i % secret.size()]);
    const auto b = static_cast<unsigned char>(sent[i]);
    difference |= static_cast<unsigned>(a ^ b);
  }
  return difference == 0U;
}

bool IsTokenCharacter(char c) { return std::isgraph(static_cast<unsigned char>(c)) != 0; }

}  // namespace

bool AccessToken::Allows(const std::string& authorization) const {
  static const std::string kScheme = "Bearer ";
  if (empty()) {
    return true;
  }
  return authorization.rfind(kScheme, 0) == 0 && EqualInConstantTime(token_, authorization.substr(kScheme.size()));
}

AccessToken ReadTokenFile(const std::filesystem::path& file) {
  using std::filesystem::perms;
  std::error_code error;
  const perms mode = std::filesystem::status(file, error).permissions();
  if (!error && mode != perms::unknown && (mode & (perms::group_all | perms::others_all)) != perms::none) {
    throw InputError(file, "the token can be read by other users; run chmod 600 on it");
  }
  std::string token = ReadTextFile(file, kMaxTokenFileBytes);
  while (!token.empty() && !IsTokenCharacter(token.back())) {
    token.pop_back();
  }
  if (token.size() < kMinTokenLength) {
    throw InputError(file, "the token is shorter than 16 characters; write a random one, e.g. openssl rand -hex 24");
  }
  for (const char c : token) {
    if (!IsTokenCharacter(c)) {
      throw InputError(file, "the token must be one line of printable characters without spaces");
    }
  }
  return AccessToken(std::move(token));
}

}  // namespace floorloc
