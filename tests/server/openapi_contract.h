// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace floorloc {

/// An answer of the server, as a client saw it.
struct SeenResponse {
  std::string method;
  std::string path;  ///< without the query
  int status = 0;
  std::string content_type;
  std::string body;
};

/// Checks answers against schema/openapi.yaml. Knows the part of JSON Schema that the document uses, and complains
/// about keywords that it does not know.
class OpenApiContract {
 public:
  OpenApiContract();

  /// What is wrong with an answer; empty when nothing is. An answer to an address that is not documented must be a
  /// problem with status 404, 405 or less specific.
  std::vector<std::string> Check(const SeenResponse& response);

  /// "GET /v1/maps", ...: everything that is documented, and what Check() has seen succeed.
  std::set<std::string> DocumentedOperations() const;
  const std::set<std::string>& exercised() const { return exercised_; }

  /// Violations of a schema by a value.
  std::vector<std::string> Validate(const nlohmann::json& schema, const nlohmann::json& value,
                                    const std::string& where) const;

 private:
  const nlohmann::json& Resolve(const nlohmann::json& node) const;
  void ValidateObject(const nlohmann::json& schema, const nlohmann::json& value, const std::string& where,
                      std::vector<std::string>& errors) const;
  void ValidateArray(const nlohmann::json& schema, const nlohmann::json& value, const std::string& where,
                     std::vector<std::string>& errors) const;
  void ValidateOneOf(const nlohmann::json& schema, const nlohmann::json& value, const std::string& where,
                     std::vector<std::string>& errors) const;
  std::string FindPath(const std::string& path) const;

  nlohmann::json document_;
  std::set<std::string> exercised_;
};

}  // namespace floorloc
