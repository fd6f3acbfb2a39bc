// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/light_consensus.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr float kMaxLog = 1.1F;  // a factor of three

// Frames that are asked at most: more do not change the answer.
constexpr std::size_t kMaxOpinions = 24;

float Mean(const cv::Vec3f& v) { return (v[0] + v[1] + v[2]) / 3.0F; }

cv::Vec3f Log(const cv::Vec3f& v) { return {std::log(v[0]), std::log(v[1]), std::log(v[2])}; }

// Bilinear; empty where any of the four cells is not seen.
std::optional<cv::Vec3f> Sample(const cv::Mat& light, const Eigen::Vector2d& cell) {
  const double u = std::floor(cell.x());
  const double v = std::floor(cell.y());
  if (u < 0.0 || v < 0.0 || u >= light.cols - 1 || v >= light.rows - 1) {
    return std::nullopt;
  }
  const auto* upper = light.ptr<cv::Vec3b>(static_cast<int>(v)) + static_cast<int>(u);
  const auto* lower = light.ptr<cv::Vec3b>(static_cast<int>(v) + 1) + static_cast<int>(u);
  if (upper[0][1] == 0 || upper[1][1] == 0 || lower[0][1] == 0 || lower[1][1] == 0) {
    return std::nullopt;
  }
  const auto a = static_cast<float>(cell.x() - u);
  const auto b = static_cast<float>(cell.y() - v);
  return (1.0F - b) * ((1.0F - a) * cv::Vec3f(upper[0]) + a * cv::Vec3f(upper[1])) +
         b * ((1.0F - a) * cv::Vec3f(lower[0]) + a * cv::Vec3f(lower[1]));
}

// Cells without an answer take on their neighbours'; all become a little smoother.
cv::Mat FillAndSmooth(const cv::Mat& log_gain, const cv::Mat& known) {
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat sum = log_gain.clone();
  cv::GaussianBlur(sum, sum, cv::Size(5, 5), 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::GaussianBlur(weight, weight, cv::Size(5, 5), 0.8, 0.8, cv::BORDER_REPLICATE);
  cv::Mat weight3;
  cv::cvtColor(cv::max(weight, 1e-3), weight3, cv::COLOR_GRAY2BGR);
  return sum / weight3;
}

}  // namespace

cv::Vec3f FrameGain::At(const FrameView& view, const Eigen::Vector2d& point_in_map) const {
  cv::Vec3f gain = view.FlatGain(point_in_map) * even;
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

LightConsensus::LightConsensus(const MosaicInput& input, const FrameIndex& index,
                               const std::vector<SurveyView>& surveys)
    : input_(input), index_(index), surveys_(surveys), grids_(MakeLightGrids(input.surveys)) {}

FrameView LightConsensus::ViewOf(int frame) const {
  return {surveys_[SurveyOf(frame)], *input_.map_from_base[static_cast<std::size_t>(frame)]};
}

std::optional<LightConsensus::Opinion> LightConsensus::Ask(int frame, const FrameView& view,
                                                           const Eigen::Vector2d& point_in_map) const {
  const cv::Mat& light = input_.exposure.light[static_cast<std::size_t>(frame)];
  const auto color = Sample(light, grids_[SurveyOf(frame)].CellFromBase(view.BaseFromMap(point_in_map)));
  if (!color) {
    return std::nullopt;
  }
  const cv::Vec3f gain = view.FlatGain(point_in_map) * input_.exposure.GainOf(static_cast<std::size_t>(frame));
  return Opinion{Log(color->mul(gain)), view.Depth(point_in_map)};
}

cv::Vec3f LightConsensus::Agree(const std::vector<Opinion>& opinions) {
  // Shadows are commoner than moving lamps: of like opinions the brighter ones weigh more.
  constexpr float kBrightness = 2.0F;
  // From a mean of all to one of those that agree best (graduated non-convexity).
  constexpr std::array<float, 6> kUsual{1.0F, 0.3F, 0.15F, 0.08F, 0.08F, 0.08F};
  cv::Vec3f agreed = cv::Vec3f::all(0.0F);
  const float any = opinions.empty() ? 0.0F : Mean(opinions.front().log_color);
  for (const float usual : kUsual) {
    cv::Vec3f sum = cv::Vec3f::all(0.0F);
    float weight_sum = 0.0F;
    for (const Opinion& opinion : opinions) {
      const float brightness = Mean(opinion.log_color);
      const float off = usual < 1.0F ? (brightness - Mean(agreed)) / usual : 0.0F;
      const float weight =
          opinion.weight * std::exp(kBrightness * (brightness - any)) / ((1.0F + off * off) * (1.0F + off * off));
      sum += weight * opinion.log_color;
      weight_sum += weight;
    }
    agreed = sum / std::max(weight_sum, 1e-20F);
  }
  return agreed;
}

FrameGain LightConsensus::GainOf(int frame) const {
  FrameGain gain{input_.exposure.GainOf(static_cast<std::size_t>(frame)), cv::Mat(), &grids_[SurveyOf(frame)]};
  if (input_.exposure.light.empty()) {
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
  for (std::size_t i = 0; i < near.size(); i += near.size() / kMaxOpinions + 1) {
    others.emplace_back(near[i], ViewOf(near[i]));
  }
  const cv::Mat& light = input_.exposure.light[static_cast<std::size_t>(frame)];
  cv::Mat log_gain = cv::Mat::zeros(light.size(), CV_32FC3);
  cv::Mat known = cv::Mat::zeros(light.size(), CV_8UC1);
  std::vector<Opinion> opinions;
  for (int v = 0; v < light.rows; ++v) {
    for (int u = 0; u < light.cols; ++u) {
      const Eigen::Vector2d point = own.MapFromBase(gain.grid->BaseFromCell(u, v));
      opinions.clear();
      for (const auto& [other, view] : others) {
        if (const auto opinion = Ask(other, view, point)) {
          opinions.push_back(*opinion);
        }
      }
      const auto mine = Ask(frame, own, point);
      if (!mine) {
        continue;
      }
      cv::Vec3f off = Agree(opinions) - mine->log_color;
      for (int c = 0; c < 3; ++c) {
        off[c] = std::clamp(off[c], -kMaxLog, kMaxLog);
      }
      log_gain.at<cv::Vec3f>(v, u) = off;
      known.at<std::uint8_t>(v, u) = 255;
    }
  }
  gain.local_log = FillAndSmooth(log_gain, known);
  return gain;
}

}  // namespace floorloc
