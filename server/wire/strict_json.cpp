// SPDX-License-Identifier: Apache-2.0
#include "server/wire/strict_json.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

namespace floorloc {
namespace {

// No request nests deeper than 5. A value takes some 50 times the memory of its text.
constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxQuotedBytes = 64;

// What a text would cost, known before anything is allocated.
struct JsonShape {
  int depth = 0;                             // up to kMaxDepth + 1
  std::size_t bytes_outside_of_strings = 0;  // quotes included
};

JsonShape ShapeOf(const std::string& text) {
  JsonShape shape;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size() && shape.depth <= kMaxDepth; ++i) {
    const char c = text[i];
    if (in_string && c != '"') {
      i += c == '\\' ? 1U : 0U;
      continue;
    }
    ++shape.bytes_outside_of_strings;
    if (c == '"') {
      in_string = !in_string;
    } else {
      depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
      shape.depth = std::max(shape.depth, depth);
    }
  }
  return shape;
}

void CheckSize(const std::string& text, std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    throw OversizedJson("The JSON text is larger than " + std::to_string(max_bytes) + " bytes.");
  }
  const JsonShape shape = ShapeOf(text);
  if (shape.depth > kMaxDepth) {
    throw MalformedJson("The JSON text is nested deeper than " + std::to_string(kMaxDepth) + " levels.");
  }
  if (shape.bytes_outside_of_strings > kMaxJsonBytes) {
    throw OversizedJson("The JSON text has more than " + std::to_string(kMaxJsonBytes) + " bytes outside of strings.");
  }
}

// Readers take the first or the last of two keys: nobody knows which one was meant.
class DuplicateKeys {
 public:
  bool operator()(int, nlohmann::json::parse_event_t event, const nlohmann::json& value) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) {
      keys_.emplace_back();
    } else if (event == Event::object_end) {
      keys_.pop_back();
    } else if (event == Event::key && !keys_.back().insert(value.get<std::string>()).second) {
      throw MalformedJson("The key '" + value.get<std::string>().substr(0, kMaxQuotedBytes) + "' is given twice.");
    }
    return true;
  }

 private:
  std::vector<std::set<std::string>> keys_;  // of the objects around the current place
};

double ReadNumber(const nlohmann::json& value, const std::string& path) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    throw JsonError(path + " must be a finite number.");
  }
  return value.get<double>();
}

}  // namespace

std::string ToText(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

nlohmann::json ParseJson(const std::string& text, std::size_t max_bytes) {
  CheckSize(text, max_bytes);
  try {
    DuplicateKeys duplicates;
    return nlohmann::json::parse(text, std::ref(duplicates));
  } catch (const nlohmann::json::parse_error& error) {
    throw MalformedJson("The text is not valid JSON at byte " + std::to_string(error.byte) + ".");
  } catch (const nlohmann::json::exception&) {
    throw MalformedJson("The JSON text has a number that is out of range.");
  }
}

JsonObject::JsonObject(const nlohmann::json& value, std::string path) : value_(&value), path_(std::move(path)) {
  if (!value.is_object()) {
    throw JsonError((path_.empty() ? std::string("The JSON text") : path_) + " must be an object.");
  }
}

bool JsonObject::Has(const std::string& key) const { return value_->contains(key); }

std::string JsonObject::PathOf(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

const nlohmann::json& JsonObject::Value(const std::string& key) {
  requested_keys_.insert(key);
  const auto it = value_->find(key);
  if (it == value_->end()) {
    throw JsonError(PathOf(key) + " is missing.");
  }
  return *it;
}

double JsonObject::Number(const std::string& key) { return ReadNumber(Value(key), PathOf(key)); }

std::int64_t JsonObject::Integer(const std::string& key, std::int64_t min, std::int64_t max) {
  const nlohmann::json& value = Value(key);
  const bool fits = value.is_number_integer() && (!value.is_number_unsigned() ||
                                                  value.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX));
  if (!fits || value.get<std::int64_t>() < min || value.get<std::int64_t>() > max) {
    throw JsonError(PathOf(key) + " must be a whole number from " + std::to_string(min) + " to " + std::to_string(max) +
                    ".");
  }
  return value.get<std::int64_t>();
}

std::string JsonObject::Text(const std::string& key) {
  const nlohmann::json& value = Value(key);
  if (!value.is_string()) {
    throw JsonError(PathOf(key) + " must be a string.");
  }
  return value.get<std::string>();
}

bool JsonObject::Bool(const std::string& key) {
  const nlohmann::json& value = Value(key);
  if (!value.is_boolean()) {
    throw JsonError(PathOf(key) + " must be true or false.");
  }
  return value.get<bool>();
}

std::vector<double> JsonObject::Numbers(const std::string& key) { return ReadNumbers(Value(key), PathOf(key)); }

JsonObject JsonObject::Object(const std::string& key) { return {Value(key), PathOf(key)}; }

void JsonObject::RejectUnknownKeys() const {
  for (const auto& item : value_->items()) {
    if (!requested_keys_.contains(item.key())) {
      throw JsonError(PathOf(item.key()) + " is not a known key.");
    }
  }
}

std::vector<double> ReadNumbers(const nlohmann::json& value, const std::string& path) {
  if (!value.is_array()) {
    throw JsonError(path + " must be an array of numbers.");
  }
  std::vector<double> numbers;
  numbers.reserve(value.size());
  for (const nlohmann::json& item : value) {
    numbers.push_back(ReadNumber(item, path + "[" + std::to_string(numbers.size()) + "]"));
  }
  return numbers;
}

}  // namespace floorloc
