// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/svg_path.h"

#include <algorithm>

#include "mapbuilder/report/number_text.h"

namespace floorloc {

void SvgPath::Add(char command, const Eigen::Vector2d& point_in_map) {
  const Eigen::Vector2d point = point_in_map - origin_m_;
  data_ += command + FixedText(point.x(), 3) + " " + FixedText(-point.y(), 3);
}

void SvgPath::Dot(const Eigen::Vector2d& point) {
  Add('M', point);
  data_ += "h0";
}

void SvgPath::Cross(const Eigen::Vector2d& point, double arm_m) {
  const Eigen::Vector2d rising(arm_m, arm_m), falling(arm_m, -arm_m);
  MoveTo(point - rising);
  LineTo(point + rising);
  MoveTo(point - falling);
  LineTo(point + falling);
}

void SvgPath::Triangle(const Eigen::Vector2d& point, double arm_m) {
  MoveTo(point + Eigen::Vector2d(0.0, arm_m));
  LineTo(point + Eigen::Vector2d(-arm_m, -0.7 * arm_m));
  LineTo(point + Eigen::Vector2d(arm_m, -0.7 * arm_m));
  data_ += "z";
}

void SvgPath::Cells(const FloorGrid& grid, std::vector<std::size_t> cells) {
  std::sort(cells.begin(), cells.end());
  const std::string side = FixedText(grid.cell_m(), 3);
  const Eigen::Vector2d to_corner(-0.5 * grid.cell_m(), 0.5 * grid.cell_m());
  for (std::size_t i = 0; i < cells.size();) {
    std::size_t end = i + 1;
    while (end < cells.size() && cells[end] == cells[end - 1] + 1 && grid.Row(cells[end]) == grid.Row(cells[i])) {
      ++end;
    }
    const std::string width = FixedText(static_cast<double>(end - i) * grid.cell_m(), 3);
    Add('M', grid.Center(cells[i]) + to_corner);
    data_.append("h").append(width).append("v").append(side).append("h-").append(width).append("z");
    i = end;
  }
}

std::string SvgPath::Element(const std::string& css_class, const std::string& style) const {
  return "<path class='" + css_class + "'" + (style.empty() ? "" : " style='" + style + "'") + " d='" + data_ + "'/>";
}

}  // namespace floorloc
