// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace floorloc {

/// JSON text or a value in it is invalid. what() is one sentence that names the field.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The text is not JSON at all.
class MalformedJson : public JsonError {
 public:
  using JsonError::JsonError;
};

/// The text is larger than any call needs.
class OversizedJson : public JsonError {
 public:
  using JsonError::JsonError;
};

inline constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 10;
/// Of calls that take a mask of 1 MiB as base64. Outside of strings, which cost no more than they are long, such a text
/// may have kMaxJsonBytes too.
inline constexpr std::size_t kMaxJsonBytesWithMask = std::size_t{2} << 20;

/// Compact JSON text. NaN and infinity become null, invalid UTF-8 becomes U+FFFD.
std::string ToText(const nlohmann::json& value);

/// Throws OversizedJson, or MalformedJson with the position of the first error. Nesting beyond 16 levels and a key that
/// an object has twice are malformed.
nlohmann::json ParseJson(const std::string& text, std::size_t max_bytes = kMaxJsonBytes);

/// Strict reader of one JSON object: every getter checks the type, RejectUnknownKeys() throws for keys that were not
/// read. The JSON value must outlive the reader. All errors are JsonError with the path of the field.
class JsonObject {
 public:
  /// path: of this object, for messages; "" for the root.
  JsonObject(const nlohmann::json& value, std::string path);

  bool Has(const std::string& key) const;
  double Number(const std::string& key);
  std::int64_t Integer(const std::string& key, std::int64_t min, std::int64_t max);
  std::string Text(const std::string& key);
  bool Bool(const std::string& key);
  std::vector<double> Numbers(const std::string& key);
  JsonObject Object(const std::string& key);
  const nlohmann::json& Value(const std::string& key);

  /// Path of a field for messages: "camera.image_width".
  std::string PathOf(const std::string& key) const;
  void RejectUnknownKeys() const;

 private:
  const nlohmann::json* value_;
  std::string path_;
  std::set<std::string> requested_keys_;
};

/// A JSON array of finite numbers. path: for messages.
std::vector<double> ReadNumbers(const nlohmann::json& value, const std::string& path);

}  // namespace floorloc
