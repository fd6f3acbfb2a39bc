// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mapbuilder/report/floor_grid.h"

namespace floorloc {

inline RectM RelativeTo(const Eigen::Vector2d& origin_m, const RectM& rect) {
  return {rect.x_min - origin_m.x(), rect.x_max - origin_m.x(), rect.y_min - origin_m.y(), rect.y_max - origin_m.y()};
}

/// Path data in metres with y down, rounded to millimetres.
class SvgPath {
 public:
  /// origin_m: map frame; drawn at (0, 0), since browsers keep SVG's coordinates as float32.
  explicit SvgPath(const Eigen::Vector2d& origin_m) : origin_m_(origin_m) {}

  void MoveTo(const Eigen::Vector2d& point) { Add('M', point); }
  void LineTo(const Eigen::Vector2d& point) { Add('L', point); }
  /// A point, drawn as a disc by round line caps.
  void Dot(const Eigen::Vector2d& point);
  void Cross(const Eigen::Vector2d& point, double arm_m);
  void Triangle(const Eigen::Vector2d& point, double arm_m);
  /// Outline of cells, one rectangle per run in a row.
  void Cells(const FloorGrid& grid, std::vector<std::size_t> cells);

  bool empty() const { return data_.empty(); }
  /// <path class='...' style='...' d='...'/>
  std::string Element(const std::string& css_class, const std::string& style = "") const;

 private:
  void Add(char command, const Eigen::Vector2d& point);

  Eigen::Vector2d origin_m_;
  std::string data_;
};

}  // namespace floorloc
