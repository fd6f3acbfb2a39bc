// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/plot/plot_trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/evaluation/trajectory_error.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr int kHeight = 760;
const cv::Rect kPlaneArea(60, 70, 640, 590);
const cv::Rect kTimeArea(820, 70, 640, 590);
constexpr int kWidth = 1500;
const cv::Scalar kInk(60, 60, 60);
const cv::Scalar kGrid(225, 225, 225);
const cv::Scalar kReferenceGray(190, 190, 190);

// Largest step of 1, 2 or 5 times a power of ten not exceeding `length`.
double RoundDown(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  const double leading = length / power;
  return power * (leading >= 5.0 ? 5.0 : leading >= 2.0 ? 2.0 : 1.0);
}

std::string NumberText(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

void PutText(cv::Mat& canvas, const std::string& text, const cv::Point& at, double size = 0.45) {
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

// Colour map of errors: dark blue at zero to dark red at the 99th percentile and above.
class ErrorColors {
 public:
  explicit ErrorColors(const std::vector<ErrorSample>& samples) {
    std::vector<double> errors;
    for (const ErrorSample& sample : samples) {
      errors.push_back(sample.error);
    }
    const auto p99 = errors.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), p99, errors.end());
    top_ = std::max(*p99, 1e-12);
    cv::Mat ramp(1, 256, CV_8UC1);
    for (int i = 0; i < 256; ++i) {
      ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
    }
    cv::applyColorMap(ramp, colors_, cv::COLORMAP_TURBO);
  }

  double top() const { return top_; }
  cv::Scalar Of(double error) const {
    return colors_.at<cv::Vec3b>(0, static_cast<int>(255.0 * std::clamp(error / top_, 0.0, 1.0)));
  }

 private:
  double top_ = 1.0;
  cv::Mat colors_;
};

// Metres -> canvas pixels: x right, y up, equal scales, centred in the area.
class PlaneView {
 public:
  explicit PlaneView(const ErrorPlot& plot) {
    std::vector<Eigen::Vector2d> positions = plot.reference_m;
    for (const ErrorSample& sample : plot.samples) {
      positions.push_back(sample.estimate_m);
    }
    Eigen::Vector2d low = positions.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& position : positions) {
      low = low.cwiseMin(position);
      high = high.cwiseMax(position);
    }
    const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
    pixels_per_m_ = 0.92 * std::min(kPlaneArea.width / size.x(), kPlaneArea.height / size.y());
    center_m_ = 0.5 * (low + high);
  }

  double pixels_per_m() const { return pixels_per_m_; }
  cv::Point operator()(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d offset = pixels_per_m_ * (p - center_m_);
    return {kPlaneArea.x + kPlaneArea.width / 2 + static_cast<int>(std::lround(offset.x())),
            kPlaneArea.y + kPlaneArea.height / 2 - static_cast<int>(std::lround(offset.y()))};
  }

 private:
  double pixels_per_m_ = 1.0;
  Eigen::Vector2d center_m_ = Eigen::Vector2d::Zero();
};

void DrawScaleBar(cv::Mat& canvas, const PlaneView& view) {
  const double length_m = RoundDown(0.3 * kPlaneArea.width / view.pixels_per_m());
  const int length_px = static_cast<int>(std::lround(length_m * view.pixels_per_m()));
  const cv::Point left(kPlaneArea.x, kPlaneArea.br().y + 40);
  const cv::Point right = left + cv::Point(length_px, 0);
  cv::line(canvas, left, right, kInk, 2, cv::LINE_AA);
  for (const cv::Point& end : {left, right}) {
    cv::line(canvas, end - cv::Point(0, 5), end + cv::Point(0, 5), kInk, 2, cv::LINE_AA);
  }
  PutText(canvas, NumberText(length_m) + " m", right + cv::Point(10, 5));
}

void DrawLegend(cv::Mat& canvas, const ErrorColors& colors, const std::string& unit) {
  const cv::Rect bar(kPlaneArea.br().x - 220, kPlaneArea.br().y + 30, 150, 14);
  for (int i = 0; i < bar.width; ++i) {
    const cv::Scalar color = colors.Of(colors.top() * i / bar.width);
    cv::line(canvas, {bar.x + i, bar.y}, {bar.x + i, bar.br().y}, color);
  }
  PutText(canvas, "0", {bar.x - 14, bar.br().y});
  PutText(canvas, ">= " + NumberText(colors.top()) + " " + unit, {bar.br().x + 8, bar.br().y});
  cv::line(canvas, {bar.x, bar.br().y + 22}, {bar.x + 30, bar.br().y + 22}, kReferenceGray, 2, cv::LINE_AA);
  PutText(canvas, "reference", {bar.x + 38, bar.br().y + 27});
}

void DrawPlane(cv::Mat& canvas, const ErrorPlot& plot, const ErrorColors& colors) {
  const PlaneView view(plot);
  for (std::size_t i = 1; i < plot.reference_m.size(); ++i) {
    cv::line(canvas, view(plot.reference_m[i - 1]), view(plot.reference_m[i]), kReferenceGray, 2, cv::LINE_AA);
  }
  for (const ErrorSample& sample : plot.samples) {
    cv::circle(canvas, view(sample.estimate_m), 4, colors.Of(sample.error), cv::FILLED, cv::LINE_AA);
  }
  DrawScaleBar(canvas, view);
  DrawLegend(canvas, colors, plot.unit);
}

// Labelled horizontal lines at round errors and vertical ones at round times.
void DrawTimeGrid(cv::Mat& canvas, double top_error, double duration_s, const std::string& unit) {
  const double error_step = RoundDown(top_error / 4.0);
  for (double error = 0.0; error <= top_error; error += error_step) {
    const int y = kTimeArea.br().y - static_cast<int>(kTimeArea.height * error / top_error);
    cv::line(canvas, {kTimeArea.x, y}, {kTimeArea.br().x, y}, kGrid);
    PutText(canvas, NumberText(std::round(error / error_step) * error_step), {kTimeArea.x - 60, y + 5});
  }
  const double time_step = RoundDown(duration_s / 4.0);
  for (double time = 0.0; time <= duration_s; time += time_step) {
    const int x = kTimeArea.x + static_cast<int>(kTimeArea.width * time / duration_s);
    cv::line(canvas, {x, kTimeArea.y}, {x, kTimeArea.br().y}, kGrid);
    PutText(canvas, NumberText(std::round(time / time_step) * time_step), {x - 8, kTimeArea.br().y + 20});
  }
  PutText(canvas, unit.empty() ? "error" : "error [" + unit + "]", {kTimeArea.x - 60, kTimeArea.y - 14});
  PutText(canvas, "time [s]", {kTimeArea.br().x - 60, kTimeArea.br().y + 45});
}

// A horizontal line for each of the usual statistics, with its value in the legend below.
void DrawStatistics(cv::Mat& canvas, const ErrorPlot& plot, double top_error) {
  std::vector<double> errors;
  for (const ErrorSample& sample : plot.samples) {
    errors.push_back(sample.error);
  }
  const ErrorStatistics statistics = Summarize(std::move(errors));
  struct Line {
    const char* name;
    double value;
    cv::Scalar color;
  };
  const std::array<Line, 3> lines = {{{"rmse", statistics.rmse, cv::Scalar(40, 40, 200)},
                                      {"mean", statistics.mean, cv::Scalar(180, 90, 20)},
                                      {"median", statistics.median, cv::Scalar(40, 130, 40)}}};
  int x = kTimeArea.x;
  for (const Line& line : lines) {
    const int y = kTimeArea.br().y - static_cast<int>(kTimeArea.height * line.value / top_error);
    cv::line(canvas, {kTimeArea.x, y}, {kTimeArea.br().x, y}, line.color);
    const int text_y = kTimeArea.br().y + 45;
    cv::line(canvas, {x, text_y - 5}, {x + 22, text_y - 5}, line.color, 2, cv::LINE_AA);
    PutText(canvas, std::string(line.name) + " " + NumberText(line.value), {x + 28, text_y});
    x += 165;
  }
}

void DrawTimes(cv::Mat& canvas, const ErrorPlot& plot, const ErrorColors& colors) {
  const double start_s = plot.samples.front().time_s;
  const double duration_s = std::max(plot.samples.back().time_s - start_s, 1e-3);
  double top_error = colors.top();
  for (const ErrorSample& sample : plot.samples) {
    top_error = std::max(top_error, sample.error);
  }
  DrawTimeGrid(canvas, top_error, duration_s, plot.unit);
  for (const ErrorSample& sample : plot.samples) {
    const cv::Point at(kTimeArea.x + static_cast<int>(kTimeArea.width * (sample.time_s - start_s) / duration_s),
                       kTimeArea.br().y - static_cast<int>(kTimeArea.height * sample.error / top_error));
    cv::circle(canvas, at, 3, colors.Of(sample.error), cv::FILLED, cv::LINE_AA);
  }
  DrawStatistics(canvas, plot, top_error);
}

}  // namespace

cv::Mat DrawErrorPlot(const ErrorPlot& plot) {
  cv::Mat canvas(kHeight, kWidth, CV_8UC3, cv::Scalar::all(255));
  const ErrorColors colors(plot.samples);
  PutText(canvas, plot.title, {kPlaneArea.x, 30}, 0.6);
  DrawPlane(canvas, plot, colors);
  DrawTimes(canvas, plot, colors);
  return canvas;
}

void WriteErrorPlot(const std::filesystem::path& file, const ErrorPlot& plot) {
  std::vector<std::uint8_t> png;
  cv::imencode(".png", DrawErrorPlot(plot), png);
  WriteFileAtomically(file, std::string(png.begin(), png.end()));
}

}  // namespace floorloc
