// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/frame_layer.h"

#include <algorithm>
#include <array>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace floorloc {
namespace {

constexpr int kCellPx = MosaicGrid::kCellPx;

// Raw image position, interpolated linearly along a row of a cell.
struct PixelPosition {
  float u, v;
};

cv::v_float32x4 LoadPixel(const std::uint8_t* bgra) {
  return cv::v_cvt_f32(cv::v_reinterpret_as_s32(cv::v_load_expand_q(bgra)));
}

cv::v_float32x4 Mix(const cv::v_float32x4& a, const cv::v_float32x4& b, float share) {
  return cv::v_muladd(b - a, cv::v_setall_f32(share), a);
}

// px: inside the image, not in its last column or row.
cv::v_float32x4 Sample(const cv::Mat& bgra, const PixelPosition& px) {
  const int column = static_cast<int>(px.u);
  const int row = static_cast<int>(px.v);
  const std::uint8_t* upper = bgra.ptr<std::uint8_t>(row) + 4 * column;
  const std::uint8_t* lower = upper + bgra.step[0];
  const float a = px.u - static_cast<float>(column);
  return Mix(Mix(LoadPixel(upper), LoadPixel(upper + 4), a), Mix(LoadPixel(lower), LoadPixel(lower + 4), a),
             px.v - static_cast<float>(row));
}

PixelPosition Between(const cv::Vec2f& a, const cv::Vec2f& b, float share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
}

// Mask of the nodes at which the frame was chosen and their neighbours: a cell needs all four nodes.
cv::Mat NeededNodes(int candidate, const NodeChoices& choices, const MosaicGrid& grid, const cv::Rect& footprint) {
  cv::Mat needed(footprint.size(), CV_8UC1);
  for (int row = 0; row < footprint.height; ++row) {
    for (int column = 0; column < footprint.width; ++column) {
      const int node = (footprint.y + row) * grid.nodes() + footprint.x + column;
      needed.at<std::uint8_t>(row, column) =
          choices[static_cast<std::size_t>(node)].Of(candidate).candidate == candidate ? 255 : 0;
    }
  }
  cv::dilate(needed, needed, cv::Mat::ones(3, 3, CV_8UC1));
  return needed;
}

}  // namespace

void PatchSums::Reset(const MosaicGrid& grid) {
  color.create(grid.side_px, grid.side_px, CV_32FC4);
  color.setTo(cv::Scalar::all(0));
  low_band.create(grid.nodes(), grid.nodes(), CV_32FC4);
  low_band.setTo(cv::Scalar::all(0));
}

FrameLayer::FrameLayer(const Source& source, const NodeChoices& choices, const MosaicGrid& grid)
    : image_(source.image),
      nodes_(source.view.Footprint(grid)),
      factor_(cv::Mat::zeros(nodes_.size(), CV_32FC4)),
      low_band_(cv::Mat::zeros(nodes_.size(), CV_32FC4)),
      raw_px_(nodes_.size(), CV_32FC2, cv::Scalar::all(0)) {
  const cv::Mat needed = NeededNodes(source.candidate, choices, grid, nodes_);
  const auto shrink = static_cast<float>(image_->shrink);
  for (int row = 0; row < nodes_.height; ++row) {
    for (int column = 0; column < nodes_.width; ++column) {
      if (needed.at<std::uint8_t>(row, column) == 0) {
        continue;
      }
      const Eigen::Vector2d point = grid.MapFromNode(nodes_.x + column, nodes_.y + row);
      const cv::Vec2f raw = source.view.RawPixel(point);
      const cv::Vec2f px((raw[0] + 0.5F) / shrink - 0.5F, (raw[1] + 0.5F) / shrink - 0.5F);
      raw_px_.at<cv::Vec2f>(row, column) = px;
      const int node = (nodes_.y + row) * grid.nodes() + nodes_.x + column;
      const NodeChoice::Chosen share = choices[static_cast<std::size_t>(node)].Of(source.candidate);
      const cv::Vec3f gain = source.gain.At(source.view, point);
      const cv::Vec4f gain4(gain[0], gain[1], gain[2], 1.0F / 255.0F);
      factor_.at<cv::Vec4f>(row, column) = share.high_band_weight * gain4;
      low_band_.at<cv::Vec4f>(row, column) =
          (share.low_band_weight - share.high_band_weight) * gain4.mul(image_->LowBandAt(px));
    }
  }
}

void FrameLayer::AddTo(PatchSums* sums, int first_row, int last_row) const {
  const int first = std::max(first_row, nodes_.y);
  const int last = std::min(last_row, nodes_.y + nodes_.height);
  for (int row = first; row < last; ++row) {
    sums->low_band(cv::Rect(nodes_.x, row, nodes_.width, 1)) += low_band_.row(row - nodes_.y);
    for (int column = nodes_.x; column + 1 < nodes_.x + nodes_.width && row + 1 < nodes_.y + nodes_.height; ++column) {
      AddCell(sums, column, row);
    }
  }
}

void FrameLayer::AddCell(PatchSums* sums, int column, int row) const {
  std::array<cv::v_float32x4, 4> factor;  // upper left, upper right, lower left, lower right
  std::array<cv::Vec2f, 4> px;
  float share = 0.0F;
  bool inside = true;
  const auto max_u = static_cast<float>(image_->bgra.cols - 1);
  const auto max_v = static_cast<float>(image_->bgra.rows - 1);
  const auto visible = [&](float u, float v) { return u >= 0.0F && v >= 0.0F && u < max_u && v < max_v; };
  for (std::size_t i = 0; i < 4; ++i) {
    const cv::Point node(column - nodes_.x + static_cast<int>(i % 2), row - nodes_.y + static_cast<int>(i / 2));
    const auto& node_factor = factor_.at<cv::Vec4f>(node);
    factor[i] = cv::v_load(node_factor.val);
    px[i] = raw_px_.at<cv::Vec2f>(node);
    share += node_factor[3];
    inside = inside && visible(px[i][0], px[i][1]);
  }
  if (share <= 0.0F) {
    return;
  }
  const int width = std::min(kCellPx, sums->color.cols - column * kCellPx);
  const int height = std::min(kCellPx, sums->color.rows - row * kCellPx);
  constexpr float kPerPx = 1.0F / kCellPx;
  for (int y = 0; y < height; ++y) {
    const float down = static_cast<float>(y) * kPerPx;
    const PixelPosition left = Between(px[0], px[2], down);
    const PixelPosition right = Between(px[1], px[3], down);
    const float du = (right.u - left.u) * kPerPx;
    const float dv = (right.v - left.v) * kPerPx;
    cv::v_float32x4 weight = Mix(factor[0], factor[2], down);
    const cv::v_float32x4 weight_step = (Mix(factor[1], factor[3], down) - weight) * cv::v_setall_f32(kPerPx);
    float* pixel = sums->color.ptr<float>(row * kCellPx + y) + 4 * column * kCellPx;
    for (int x = 0; x < width; ++x, pixel += 4, weight += weight_step) {
      const PixelPosition position{left.u + static_cast<float>(x) * du, left.v + static_cast<float>(x) * dv};
      if (inside || visible(position.u, position.v)) {
        cv::v_store(pixel, cv::v_muladd(weight, Sample(image_->bgra, position), cv::v_load(pixel)));
      }
    }
  }
}

}  // namespace floorloc
