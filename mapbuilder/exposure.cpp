// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/exposure.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr double kMaxGain = 4.0;

// Mean brightness of every coarse cell over all frames of a survey, relative to the mean of all cells.
cv::Mat RelativeMean(const std::vector<BuildFrame>& frames, int survey) {
  cv::Mat sum;
  cv::Mat count;
  for (const BuildFrame& frame : frames) {
    if (frame.survey != survey) {
      continue;
    }
    if (sum.empty()) {
      sum = cv::Mat::zeros(frame.brightness.size(), CV_32F);
      count = cv::Mat::zeros(frame.brightness.size(), CV_32F);
    }
    cv::Mat seen;
    cv::Mat(frame.brightness > 0.0F).convertTo(seen, CV_32F, 1.0 / 255.0);
    sum += frame.brightness;
    count += seen;
  }
  const double mean = cv::sum(sum)[0] / std::max(1.0, cv::sum(count)[0]);
  cv::Mat relative = cv::Mat::ones(sum.size(), CV_32F);
  for (int v = 0; v < sum.rows && mean > 0.0; ++v) {
    for (int u = 0; u < sum.cols; ++u) {
      if (count.at<float>(v, u) > 0.0F && sum.at<float>(v, u) > 0.0F) {
        relative.at<float>(v, u) = static_cast<float>(sum.at<float>(v, u) / count.at<float>(v, u) / mean);
      }
    }
  }
  return relative;
}

// What turns a survey's brightness into that of the floor.
struct Lighting {
  cv::Mat relative;  // of each coarse cell
  GroundGrid grid;
};

// Mean over the shared floor of log(second / first), both without vignetting; empty when too little is shared.
std::optional<double> LogRatio(const BuildFrame& first, const BuildFrame& second, const Pose2& first_from_second,
                               const Lighting& light) {
  double sum = 0.0;
  int count = 0;
  for (int v = 0; v < second.brightness.rows; ++v) {
    for (int u = 0; u < second.brightness.cols; ++u) {
      const Eigen::Vector2d p =
          first_from_second * light.grid.BaseFromPixel((u + 0.5) * kBrightnessCellPx, (v + 0.5) * kBrightnessCellPx);
      const Eigen::Vector2d cell = light.grid.PixelFromBase(p) / kBrightnessCellPx;
      const int fu = static_cast<int>(std::floor(cell.x()));
      const int fv = static_cast<int>(std::floor(cell.y()));
      if (fu < 0 || fv < 0 || fu >= first.brightness.cols || fv >= first.brightness.rows) {
        continue;
      }
      const float a = first.brightness.at<float>(fv, fu);
      const float b = second.brightness.at<float>(v, u);
      if (a > 1.0F && b > 1.0F) {
        sum += std::log(b / light.relative.at<float>(v, u)) - std::log(a / light.relative.at<float>(fv, fu));
        ++count;
      }
    }
  }
  constexpr int kMinCells = 8;
  return count >= kMinCells ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

Exposure EstimateExposure(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                          const std::vector<Link>& links) {
  Exposure exposure;
  std::vector<Lighting> lighting;
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    lighting.push_back({RelativeMean(frames, static_cast<int>(s)), surveys[s].rectifier->grid()});
    const GroundGrid& grid = lighting.back().grid;
    cv::Mat field;
    cv::resize(lighting.back().relative, field, cv::Size(grid.width_px, grid.height_px), 0, 0, cv::INTER_CUBIC);
    field = cv::max(field, 1.0 / kMaxGain);
    exposure.flat_field.push_back(1.0 / field);
  }
  // Minimise sum (g_first - g_second - log(second / first))^2 + small * sum g^2, g = log gain.
  constexpr double kPull = 1e-2;
  const auto n = static_cast<Eigen::Index>(frames.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, kPull);
  }
  for (const Link& link : links) {
    const BuildFrame& first = frames[static_cast<std::size_t>(link.first)];
    const BuildFrame& second = frames[static_cast<std::size_t>(link.second)];
    if (first.survey != second.survey) {
      continue;
    }
    const auto log_ratio =
        LogRatio(first, second, link.first_from_second, lighting[static_cast<std::size_t>(first.survey)]);
    if (!log_ratio) {
      continue;
    }
    entries.emplace_back(link.first, link.first, 1.0);
    entries.emplace_back(link.second, link.second, 1.0);
    entries.emplace_back(link.first, link.second, -1.0);
    entries.emplace_back(link.second, link.first, -1.0);
    right[link.first] += *log_ratio;
    right[link.second] -= *log_ratio;
  }
  Eigen::SparseMatrix<double> normal(n, n);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  const Eigen::VectorXd log_gain = solver.solve(right);
  for (Eigen::Index i = 0; i < n; ++i) {
    exposure.frame_gain.push_back(std::clamp(std::exp(log_gain[i]), 1.0 / kMaxGain, kMaxGain));
  }
  return exposure;
}

}  // namespace floorloc
