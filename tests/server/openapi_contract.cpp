// SPDX-License-Identifier: Apache-2.0
#include "tests/server/openapi_contract.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>

#include "schema/embedded.h"
#include "server/router.h"

namespace floorloc {
namespace {

using nlohmann::json;

json ScalarToJson(const YAML::Node& node) {
  const bool quoted = node.Tag() == "!";
  const json parsed = quoted ? json() : json::parse(node.Scalar(), nullptr, false);
  return quoted || parsed.is_discarded() ? json(node.Scalar()) : parsed;
}

json ToJson(const YAML::Node& node) {
  if (node.IsMap()) {
    json object = json::object();
    for (const auto& item : node) {
      object[item.first.Scalar()] = ToJson(item.second);
    }
    return object;
  }
  if (node.IsSequence()) {
    json array = json::array();
    for (const auto& item : node) {
      array.push_back(ToJson(item));
    }
    return array;
  }
  return node.IsNull() ? json() : ScalarToJson(node);
}

bool HasType(const json& value, const std::string& type) {
  if (type == "integer") {
    return value.is_number_integer();
  }
  if (type == "number") {
    return value.is_number();
  }
  return type == (value.is_null() ? "null" : value.type_name());
}

const std::set<std::string>& KnownKeywords() {
  static const std::set<std::string> known = {"$ref",
                                              "additionalProperties",
                                              "const",
                                              "contentMediaType",
                                              "default",
                                              "description",
                                              "enum",
                                              "items",
                                              "exclusiveMinimum",
                                              "maxItems",
                                              "maximum",
                                              "minItems",
                                              "minimum",
                                              "oneOf",
                                              "pattern",
                                              "properties",
                                              "required",
                                              "type"};
  return known;
}

void ValidateNumber(const json& schema, double value, const std::string& where, std::vector<std::string>& errors) {
  if ((schema.contains("minimum") && value < schema["minimum"].get<double>()) ||
      (schema.contains("maximum") && value > schema["maximum"].get<double>()) ||
      (schema.contains("exclusiveMinimum") && value <= schema["exclusiveMinimum"].get<double>())) {
    errors.push_back(where + " is out of range: " + std::to_string(value));
  }
}

std::string MediaType(const std::string& content_type) { return content_type.substr(0, content_type.find(';')); }

std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

OpenApiContract::OpenApiContract() : document_(ToJson(YAML::Load(std::string(OpenApiYaml())))) {}

std::set<std::string> OpenApiContract::DocumentedOperations() const {
  std::set<std::string> operations;
  for (const auto& [path, item] : document_["paths"].items()) {
    for (const auto& [key, operation] : item.items()) {
      if (key == "parameters") {
        continue;
      }
      std::string method = key;
      std::transform(method.begin(), method.end(), method.begin(),
                     [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
      operations.insert(method + " " + path);
    }
  }
  return operations;
}

const json& OpenApiContract::Resolve(const json& node) const {
  if (!node.is_object() || !node.contains("$ref")) {
    return node;
  }
  return Resolve(document_.at(json::json_pointer(node["$ref"].get<std::string>().substr(1))));
}

std::string OpenApiContract::FindPath(const std::string& path) const {
  for (const auto& [pattern, item] : document_["paths"].items()) {
    if (MatchPattern(pattern, path)) {
      return pattern;
    }
  }
  return "";
}

std::vector<std::string> OpenApiContract::Check(const SeenResponse& response) {
  const std::string where = response.method + " " + response.path + " -> " + std::to_string(response.status);
  const std::string pattern = FindPath(response.path);
  const std::string method = response.method == "HEAD" ? "get" : LowerCase(response.method);
  const bool documented = !pattern.empty() && document_["paths"][pattern].contains(method);
  const json problem = {{"$ref", "#/components/responses/Problem"}};
  const json responses = documented ? document_["paths"][pattern][method]["responses"] : json{{"default", problem}};
  const std::string status = std::to_string(response.status);
  if (response.status < 400 && !responses.contains(status)) {
    return {where + ": this status is not documented"};
  }
  const json described = Resolve(responses.contains(status) ? responses[status] : responses["default"]);
  if (response.status < 400) {
    exercised_.insert(response.method + " " + pattern);
  }
  if (!described.contains("content")) {
    return response.body.empty() ? std::vector<std::string>{} : std::vector<std::string>{where + ": has a body"};
  }
  const std::string type = MediaType(response.content_type);
  if (!described["content"].contains(type)) {
    return {where + ": the content type '" + type + "' is not documented"};
  }
  if (response.method == "HEAD" || type.find("json") == std::string::npos) {
    return {};
  }
  const json body = json::parse(response.body, nullptr, false);
  return body.is_discarded() ? std::vector<std::string>{where + ": the body is not JSON"}
                             : Validate(described["content"][type]["schema"], body, where);
}

std::vector<std::string> OpenApiContract::Validate(const json& schema_or_ref, const json& value,
                                                   const std::string& where) const {
  const json& schema = Resolve(schema_or_ref);
  std::vector<std::string> errors;
  for (const auto& [keyword, unused] : schema.items()) {
    if (!KnownKeywords().contains(keyword)) {
      errors.push_back(where + ": the schema keyword '" + keyword + "' is not known to this test");
    }
  }
  if (schema.contains("type") && !HasType(value, schema["type"])) {
    return {where + " is not of type " + schema["type"].dump() + ": " + value.dump()};
  }
  if (schema.contains("const") && schema["const"] != value) {
    errors.push_back(where + " is not " + schema["const"].dump());
  }
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end()) {
    errors.push_back(where + " is not one of " + schema["enum"].dump() + ": " + value.dump());
  }
  if (value.is_string() && schema.contains("pattern") &&
      !std::regex_search(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>()))) {
    errors.push_back(where + " does not match " + schema["pattern"].dump() + ": " + value.dump());
  }
  if (value.is_number()) {
    ValidateNumber(schema, value, where, errors);
  }
  ValidateObject(schema, value, where, errors);
  ValidateArray(schema, value, where, errors);
  ValidateOneOf(schema, value, where, errors);
  return errors;
}

void OpenApiContract::ValidateObject(const json& schema, const json& value, const std::string& where,
                                     std::vector<std::string>& errors) const {
  if (!value.is_object()) {
    return;
  }
  for (const json& key : schema.value("required", json::array())) {
    if (!value.contains(key.get<std::string>())) {
      errors.push_back(where + " lacks " + key.dump());
    }
  }
  const json properties = schema.value("properties", json::object());
  for (const auto& [key, item] : value.items()) {
    if (properties.contains(key)) {
      const auto more = Validate(properties[key], item, where + "." + key);
      errors.insert(errors.end(), more.begin(), more.end());
    } else if (!schema.value("additionalProperties", true)) {
      errors.push_back(where + " has the unknown key " + key);
    }
  }
}

void OpenApiContract::ValidateArray(const json& schema, const json& value, const std::string& where,
                                    std::vector<std::string>& errors) const {
  if (!value.is_array()) {
    return;
  }
  if (value.size() < schema.value("minItems", std::size_t{0}) ||
      value.size() > schema.value("maxItems", value.size())) {
    errors.push_back(where + " has the wrong number of items: " + std::to_string(value.size()));
  }
  for (std::size_t i = 0; schema.contains("items") && i < value.size(); ++i) {
    const auto more = Validate(schema["items"], value[i], where + "[" + std::to_string(i) + "]");
    errors.insert(errors.end(), more.begin(), more.end());
  }
}

void OpenApiContract::ValidateOneOf(const json& schema, const json& value, const std::string& where,
                                    std::vector<std::string>& errors) const {
  if (!schema.contains("oneOf")) {
    return;
  }
  int matching = 0;
  std::string reasons;
  for (const json& choice : schema["oneOf"]) {
    const auto wrong = Validate(choice, value, where);
    matching += wrong.empty() ? 1 : 0;
    reasons += wrong.empty() ? "" : " / " + wrong.front();
  }
  if (matching != 1) {
    errors.push_back(where + " matches " + std::to_string(matching) + " schemas of oneOf:" + reasons);
  }
}

}  // namespace floorloc
