// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace floorloc {

std::string_view MapSql();       ///< schema/map.sql
std::string_view StateSql();     ///< schema/state.sql
std::string_view OpenApiYaml();  ///< schema/openapi.yaml

}  // namespace floorloc
