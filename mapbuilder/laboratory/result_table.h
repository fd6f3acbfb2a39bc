// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace floorloc {

/// A column of a result table.
struct TableColumn {
  std::string key;   ///< key in JSON, with its unit
  std::string head;  ///< displayed
  int decimals = 0;  ///< of displayed numbers
};

/// Missing value, text, or number.
using TableCell = std::variant<std::monostate, std::string, double>;

struct ResultTable {
  std::string title;
  std::vector<std::string> notes;  ///< explanations for the reader
  std::vector<TableColumn> columns;
  std::vector<std::vector<TableCell>> rows;  ///< one cell per column; missing ones are empty
};

/// The number, or a missing value if it is not finite.
TableCell NumberCell(double value);

/// Displayed text of the cell; "-" for a missing value.
std::string CellText(const TableCell& cell, int decimals);

/// Text with aligned columns.
std::string ToText(const ResultTable& table);

/// {"title", "notes", "rows": [{key: value}]}; missing values are null.
nlohmann::ordered_json ToJson(const ResultTable& table);

}  // namespace floorloc
