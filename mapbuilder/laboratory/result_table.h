// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace floorloc {

/// A column of a table of results.
struct TableColumn {
  std::string key;   ///< in JSON, with its unit
  std::string head;  ///< for people
  int decimals = 0;  ///< of its numbers
};

/// Nothing is known, a word, or a number.
using TableCell = std::variant<std::monostate, std::string, double>;

struct ResultTable {
  std::string title;
  std::vector<std::string> notes;  ///< what one must know to read it
  std::vector<TableColumn> columns;
  std::vector<std::vector<TableCell>> rows;  ///< one cell per column; missing ones are empty
};

/// The number, or nothing where it is not finite.
TableCell NumberCell(double value);

/// What a person reads in the cell; "-" for nothing.
std::string CellText(const TableCell& cell, int decimals);

/// Aligned columns for a terminal.
std::string ToText(const ResultTable& table);

/// {"title", "notes", "rows": [{key: value}]}; what is not known is null.
nlohmann::ordered_json ToJson(const ResultTable& table);

}  // namespace floorloc
