// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/result_table.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

namespace floorloc {
namespace {

const TableCell& CellAt(const std::vector<TableCell>& row, std::size_t column) {
  static const TableCell nothing;
  return column < row.size() ? row[column] : nothing;
}

// Text is aligned left, numbers right.
bool IsWord(const TableCell& cell) { return std::holds_alternative<std::string>(cell); }

void Pad(std::ostringstream& out, const std::string& text, std::size_t width, bool left) {
  out << (left ? std::left : std::right) << std::setw(static_cast<int>(width)) << text << "  ";
}

}  // namespace

TableCell NumberCell(double value) { return std::isfinite(value) ? TableCell(value) : TableCell(); }

std::string CellText(const TableCell& cell, int decimals) {
  if (const auto* word = std::get_if<std::string>(&cell)) {
    return *word;
  }
  if (const auto* number = std::get_if<double>(&cell)) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(decimals) << *number;
    return text.str();
  }
  return "-";
}

std::string ToText(const ResultTable& table) {
  std::ostringstream out;
  out << table.title << "\n";
  for (const std::string& note : table.notes) {
    out << "  " << note << "\n";
  }
  out << "\n";
  std::vector<std::size_t> widths;
  std::vector<bool> left;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    std::size_t width = table.columns[c].head.size();
    bool words = false;
    for (const auto& row : table.rows) {
      width = std::max(width, CellText(CellAt(row, c), table.columns[c].decimals).size());
      words = words || IsWord(CellAt(row, c));
    }
    widths.push_back(width);
    left.push_back(words);
    Pad(out, table.columns[c].head, width, words);
  }
  out << "\n";
  for (const auto& row : table.rows) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      Pad(out, CellText(CellAt(row, c), table.columns[c].decimals), widths[c], left[c]);
    }
    out << "\n";
  }
  return out.str();
}

nlohmann::ordered_json ToJson(const ResultTable& table) {
  nlohmann::ordered_json json{{"title", table.title}, {"notes", table.notes}, {"rows", nlohmann::json::array()}};
  for (const auto& row : table.rows) {
    nlohmann::ordered_json object;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const TableCell& cell = CellAt(row, c);
      nlohmann::ordered_json& value = object[table.columns[c].key];
      if (const auto* word = std::get_if<std::string>(&cell)) {
        value = *word;
      } else if (const auto* number = std::get_if<double>(&cell)) {
        value = *number;
      } else {
        value = nullptr;
      }
    }
    json["rows"].push_back(object);
  }
  return json;
}

}  // namespace floorloc
