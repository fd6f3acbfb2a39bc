// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/floor_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/vision/image/rectifier.h"

namespace floorloc {
namespace {

constexpr double kWantedSidePx = 800.0;
constexpr int kMarginPx = 70;
constexpr double kGridLines = 8.0;

const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kLine(255, 220, 120);
const cv::Scalar kObserved(0, 0, 255);
const cv::Scalar kExpected(0, 220, 0);

// 1, 2 or 5 times a power of ten, such that about kGridLines steps span the length.
double GridStep(double length_m) {
  const double wanted = length_m / kGridLines;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= wanted) {
      return digit * power;
    }
  }
  return 10.0 * power;
}

std::string Metres(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.2f", std::abs(value) < 1e-9 ? 0.0 : value);
  return buffer.data();
}

class GridCanvas {
 public:
  GridCanvas(const GroundGrid& grid, const cv::Mat& rectified) : grid_(grid) {
    factor_ = std::max(0.1, kWantedSidePx / std::max(rectified.cols, rectified.rows));
    cv::Mat scaled;
    cv::resize(rectified, scaled, {}, factor_, factor_, factor_ > 1.0 ? cv::INTER_LINEAR : cv::INTER_AREA);
    cv::copyMakeBorder(scaled, canvas_, kMarginPx / 2, kMarginPx, kMarginPx, kMarginPx / 2, cv::BORDER_CONSTANT,
                       cv::Scalar::all(255));
    area_ = cv::Rect(kMarginPx, kMarginPx / 2, scaled.cols, scaled.rows);
  }

  void DrawLines(const RectM& roi) {
    const double step = GridStep(std::max(roi.width_m(), roi.height_m()));
    for (double i = std::ceil(roi.x_min / step - 1e-6); i * step <= roi.x_max + 1e-9; ++i) {
      const int v = PixelOf({i * step, roi.y_min}).y;
      cv::line(canvas_, {area_.x, v}, {area_.br().x - 1, v}, kLine, 1, cv::LINE_AA);
      Write("x " + Metres(i * step), {4, v + 4});
    }
    for (double i = std::ceil(roi.y_min / step - 1e-6); i * step <= roi.y_max + 1e-9; ++i) {
      const int u = PixelOf({roi.x_min, i * step}).x;
      cv::line(canvas_, {u, area_.y}, {u, area_.br().y - 1}, kLine, 1, cv::LINE_AA);
      Write("y " + Metres(i * step), {u - 26, area_.br().y + 18});
    }
  }

  void DrawCorner(const Eigen::Vector2d& expected_m, const Eigen::Vector2d& observed_m) {
    cv::circle(canvas_, PixelOf(expected_m), 7, kExpected, 1, cv::LINE_AA);
    cv::drawMarker(canvas_, PixelOf(observed_m), kObserved, cv::MARKER_CROSS, 9, 1, cv::LINE_AA);
  }

  void WriteLegend(const std::string& text) { Write(text, {area_.x, area_.br().y + 48}); }

  const cv::Mat& image() const { return canvas_; }

 private:
  cv::Point PixelOf(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d p = grid_.PixelFromBase(point_m) * factor_;
    return {area_.x + static_cast<int>(std::lround(p.x())), area_.y + static_cast<int>(std::lround(p.y()))};
  }

  void Write(const std::string& text, const cv::Point& position) {
    cv::putText(canvas_, text, position, cv::FONT_HERSHEY_SIMPLEX, 0.42, kInk, 1, cv::LINE_AA);
  }

  GroundGrid grid_;
  double factor_ = 1.0;
  cv::Mat canvas_;
  cv::Rect area_;
};

}  // namespace

cv::Mat DrawFloorGrid(const FloorCamera& camera, const cv::Mat& raw, const ObservedAndExpected& corners) {
  const Rectifier rectifier(camera);
  GridCanvas canvas(rectifier.grid(), rectifier.RectifyImage(raw));
  canvas.DrawLines(camera.floor.roi);
  for (std::size_t i = 0; i < corners.observed_px.size(); ++i) {
    canvas.DrawCorner(camera.FloorFromRawPixel(corners.expected_px[i]),
                      camera.FloorFromRawPixel(corners.observed_px[i]));
  }
  canvas.WriteLegend("base frame, metres: x forward (up), y left; corners seen (+) and expected (o)");
  return canvas.image();
}

}  // namespace floorloc
