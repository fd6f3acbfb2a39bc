// SPDX-License-Identifier: Apache-2.0
#include "core/map/content_hash.h"

#include <openssl/evp.h>

#include <array>
#include <bit>
#include <stdexcept>

namespace floorloc {
namespace {

constexpr std::size_t kDigestBytes = 32;

void Require(int code) {
  if (code != 1) {
    throw std::runtime_error("SHA-256 is not available in this OpenSSL");
  }
}

}  // namespace

struct ContentHash::Impl {
  struct Free {
    void operator()(EVP_MD_CTX* handle) const { EVP_MD_CTX_free(handle); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context{EVP_MD_CTX_new()};

  std::array<std::uint8_t, kDigestBytes> Digest() {
    std::array<std::uint8_t, kDigestBytes> digest{};
    Require(EVP_DigestFinal_ex(context.get(), digest.data(), nullptr));
    return digest;
  }
};

ContentHash::ContentHash() : impl_(std::make_unique<Impl>()) {
  Require(EVP_DigestInit_ex(impl_->context.get(), EVP_sha256(), nullptr));
}

ContentHash::~ContentHash() = default;

ContentHash& ContentHash::Add(std::span<const std::uint8_t> bytes) {
  Require(EVP_DigestUpdate(impl_->context.get(), bytes.data(), bytes.size()));
  return *this;
}

ContentHash& ContentHash::Add(std::int64_t number) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (56 - 8 * i));
  }
  return Add(bytes);
}

ContentHash& ContentHash::Add(double number) { return Add(std::bit_cast<std::int64_t>(number)); }

ContentHash& ContentHash::Add(const std::string& text) {
  Add(static_cast<std::int64_t>(text.size()));
  return Add(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::string ContentHash::Hex() {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : impl_->Digest()) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}

std::int64_t ContentHash::Checksum() {
  const auto digest = impl_->Digest();
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    value = value << 8 | digest[i];
  }
  return static_cast<std::int64_t>(value);
}

}  // namespace floorloc
