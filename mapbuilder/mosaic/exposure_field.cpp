// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/exposure_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr float kMaxLog = 1.1F;  // a factor of three

// Maximum number of frames sampled; more do not change the result.
constexpr std::size_t kMaxSamples = 24;

float Mean(const cv::Vec3f& v) { return (v[0] + v[1] + v[2]) / 3.0F; }

cv::Vec3f Log(const cv::Vec3f& v) { return {std::log(v[0]), std::log(v[1]), std::log(v[2])}; }

// Bilinear; empty if any of the four cells is invalid.
std::optional<cv::Vec3f> Interpolate(const cv::Mat& cell_colors, const Eigen::Vector2d& cell) {
  const double u = std::floor(cell.x());
  const double v = std::floor(cell.y());
  if (u < 0.0 || v < 0.0 || u >= cell_colors.cols - 1 || v >= cell_colors.rows - 1) {
    return std::nullopt;
  }
  const auto* upper = cell_colors.ptr<cv::Vec3b>(static_cast<int>(v)) + static_cast<int>(u);
  const auto* lower = cell_colors.ptr<cv::Vec3b>(static_cast<int>(v) + 1) + static_cast<int>(u);
  if (upper[0][1] == 0 || upper[1][1] == 0 || lower[0][1] == 0 || lower[1][1] == 0) {
    return std::nullopt;
  }
  const auto a = static_cast<float>(cell.x() - u);
  const auto b = static_cast<float>(cell.y() - v);
  return (1.0F - b) * ((1.0F - a) * cv::Vec3f(upper[0]) + a * cv::Vec3f(upper[1])) +
         b * ((1.0F - a) * cv::Vec3f(lower[0]) + a * cv::Vec3f(lower[1]));
}

// Fills invalid cells from their neighbours and smooths slightly.
cv::Mat FillAndSmooth(const cv::Mat& log_gain, const cv::Mat& valid) {
  cv::Mat weight;
  valid.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat sum = log_gain.clone();
  cv::GaussianBlur(sum, sum, cv::Size(5, 5), 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::GaussianBlur(weight, weight, cv::Size(5, 5), 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::Mat weight3;
  cv::cvtColor(cv::max(weight, 1e-3), weight3, cv::COLOR_GRAY2BGR);
  return sum / weight3;
}

}  // namespace

cv::Vec3f FrameGain::At(const FrameView& view, const Eigen::Vector2d& point_in_map) const {
  cv::Vec3f gain = view.FlatGain(point_in_map) * uniform;
  if (local_log.empty()) {
    return gain;
  }
  const Eigen::Vector2d cell = grid->CellFromBase(view.BaseFromMap(point_in_map));
  const auto u = std::clamp(static_cast<float>(cell.x()), 0.0F, static_cast<float>(local_log.cols - 1));
  const auto v = std::clamp(static_cast<float>(cell.y()), 0.0F, static_cast<float>(local_log.rows - 1));
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const int right = std::min(column + 1, local_log.cols - 1);
  const auto* upper = local_log.ptr<cv::Vec3f>(row);
  const auto* lower = local_log.ptr<cv::Vec3f>(std::min(row + 1, local_log.rows - 1));
  const float a = u - static_cast<float>(column);
  const float b = v - static_cast<float>(row);
  const cv::Vec3f log_gain = (1.0F - b) * ((1.0F - a) * upper[column] + a * upper[right]) +
                             b * ((1.0F - a) * lower[column] + a * lower[right]);
  for (int c = 0; c < 3; ++c) {
    gain[c] *= std::exp(log_gain[c]);
  }
  return gain;
}

ExposureField::ExposureField(const MosaicInput& input, const FrameIndex& index, const std::vector<SurveyView>& surveys)
    : input_(input), index_(index), surveys_(surveys), grids_(MakeExposureGrids(input.surveys)) {}

FrameView ExposureField::ViewOf(int frame) const {
  const auto i = static_cast<std::size_t>(frame);
  return {surveys_[SurveyOf(frame)], *input_.map_from_base[i], input_.frames[i]};
}

std::optional<ExposureField::ColorSample> ExposureField::SampleFrame(int frame, const FrameView& view,
                                                                     const Eigen::Vector2d& point_in_map) const {
  const cv::Mat& cell_colors = input_.exposure.cell_colors[static_cast<std::size_t>(frame)];
  const auto color = Interpolate(cell_colors, grids_[SurveyOf(frame)].CellFromBase(view.BaseFromMap(point_in_map)));
  if (!color) {
    return std::nullopt;
  }
  const cv::Vec3f gain = view.FlatGain(point_in_map) * input_.exposure.GainOf(static_cast<std::size_t>(frame));
  return ColorSample{Log(color->mul(gain)), view.Depth(point_in_map)};
}

cv::Vec3f ExposureField::RobustMean(const std::vector<ColorSample>& samples) {
  // Shadows are more frequent than moving lamps, so brighter samples get more weight.
  constexpr float kBrightness = 2.0F;
  // Scales of the robust kernel, from a plain mean to the mode (graduated non-convexity).
  constexpr std::array<float, 6> kScales{1.0F, 0.3F, 0.15F, 0.08F, 0.08F, 0.08F};
  cv::Vec3f mean = cv::Vec3f::all(0.0F);
  const float any = samples.empty() ? 0.0F : Mean(samples.front().log_color);
  for (const float scale : kScales) {
    cv::Vec3f sum = cv::Vec3f::all(0.0F);
    float weight_sum = 0.0F;
    for (const ColorSample& sample : samples) {
      const float brightness = Mean(sample.log_color);
      const float off = scale < 1.0F ? (brightness - Mean(mean)) / scale : 0.0F;
      const float weight =
          sample.weight * std::exp(kBrightness * (brightness - any)) / ((1.0F + off * off) * (1.0F + off * off));
      sum += weight * sample.log_color;
      weight_sum += weight;
    }
    mean = sum / std::max(weight_sum, 1e-20F);
  }
  return mean;
}

FrameGain ExposureField::GainOf(int frame) const {
  FrameGain gain{input_.exposure.GainOf(static_cast<std::size_t>(frame)), cv::Mat(), &grids_[SurveyOf(frame)]};
  if (input_.exposure.cell_colors.empty()) {
    return gain;
  }
  const FrameView own = ViewOf(frame);
  const RectM& roi = surveys_[SurveyOf(frame)].rectifier->camera().floor.roi;
  Eigen::AlignedBox2d box;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      box.extend(own.MapFromBase({x, y}));
    }
  }
  const std::vector<int> near = index_.Touching({box.min().x(), box.max().x(), box.min().y(), box.max().y()});
  std::vector<std::pair<int, FrameView>> others;
  for (std::size_t i = 0; i < near.size(); i += near.size() / kMaxSamples + 1) {
    others.emplace_back(near[i], ViewOf(near[i]));
  }
  const cv::Mat& cell_colors = input_.exposure.cell_colors[static_cast<std::size_t>(frame)];
  cv::Mat log_gain = cv::Mat::zeros(cell_colors.size(), CV_32FC3);
  cv::Mat valid = cv::Mat::zeros(cell_colors.size(), CV_8UC1);
  std::vector<ColorSample> samples;
  for (int v = 0; v < cell_colors.rows; ++v) {
    for (int u = 0; u < cell_colors.cols; ++u) {
      const Eigen::Vector2d point = own.MapFromBase(gain.grid->BaseFromCell(u, v));
      samples.clear();
      for (const auto& [other, view] : others) {
        if (const auto sample = SampleFrame(other, view, point)) {
          samples.push_back(*sample);
        }
      }
      const auto own_sample = SampleFrame(frame, own, point);
      if (!own_sample) {
        continue;
      }
      cv::Vec3f off = RobustMean(samples) - own_sample->log_color;
      for (int c = 0; c < 3; ++c) {
        off[c] = std::clamp(off[c], -kMaxLog, kMaxLog);
      }
      log_gain.at<cv::Vec3f>(v, u) = off;
      valid.at<std::uint8_t>(v, u) = 255;
    }
  }
  gain.local_log = FillAndSmooth(log_gain, valid);
  return gain;
}

}  // namespace floorloc
