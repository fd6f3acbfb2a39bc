// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_mosaic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

// Spacing of the nodes at which the warp is computed; it is interpolated linearly between them.
constexpr int kNodePx = 16;

// Interpolates between the nodes. cv::warpAffine would round to 1/32 of a node, i.e. half a pixel.
cv::Mat BetweenNodes(const cv::Mat& nodes, int side_px) {
  cv::Mat dense(side_px, side_px, CV_32FC2);
  for (int row = 0; row < side_px; ++row) {
    const int r = row / kNodePx;
    const float v = static_cast<float>(row % kNodePx) / kNodePx;
    for (int column = 0; column < side_px; ++column) {
      const int c = column / kNodePx;
      const float u = static_cast<float>(column % kNodePx) / kNodePx;
      dense.at<cv::Vec2f>(row, column) =
          (1.0F - v) * ((1.0F - u) * nodes.at<cv::Vec2f>(r, c) + u * nodes.at<cv::Vec2f>(r, c + 1)) +
          v * ((1.0F - u) * nodes.at<cv::Vec2f>(r + 1, c) + u * nodes.at<cv::Vec2f>(r + 1, c + 1));
    }
  }
  return dense;
}

}  // namespace

MosaicPatch MapMosaic::ReadPatch(const RectM& square, int side_px) const {
  return ReadPatch(square, side_px, [](const Eigen::Vector2d& p) { return p; });
}

MosaicPatch MapMosaic::ReadPatch(const RectM& square, int side_px, const Warp& own_from_other) const {
  const int count = side_px / kNodePx + 2;
  const double step_m = square.width_m() / side_px;
  cv::Mat nodes(count, count, CV_64FC2);  // in pixels of the finest level, y up
  Eigen::AlignedBox2d box;
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column) {
      const Eigen::Vector2d p(square.x_min + (kNodePx * column + 0.5) * step_m,
                              square.y_max - (kNodePx * row + 0.5) * step_m);
      const Eigen::Vector2d px = own_from_other(p) / layout_.resolution_m;
      nodes.at<cv::Vec2d>(row, column) = {px.x(), px.y()};
      box.extend(px);
    }
  }
  const Eigen::Vector2i first = ((box.min().array() - 1.0) / layout_.tile_px).floor().matrix().cast<int>();
  const Eigen::Vector2i last = ((box.max().array() + 1.0) / layout_.tile_px).floor().matrix().cast<int>();
  const cv::Mat source = ReadTiles(first, last);
  if (source.empty()) {
    return {};
  }
  // The centre of the source's upper left pixel is half a pixel inside its corner; rows run down.
  const double left = first.x() * layout_.tile_px + 0.5;
  const double top = (last.y() + 1) * layout_.tile_px - 0.5;
  std::for_each(nodes.begin<cv::Vec2d>(), nodes.end<cv::Vec2d>(), [&](cv::Vec2d& node) {
    node = {node[0] - left, top - node[1]};
  });
  nodes.convertTo(nodes, CV_32F);
  const cv::Mat source_from_patch = BetweenNodes(nodes, side_px);
  MosaicPatch patch;
  cv::Mat valid;
  cv::remap(source, patch.bgr, source_from_patch, cv::Mat(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  cv::remap(SurveyedPixels(source), valid, source_from_patch, cv::Mat(), cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  patch.valid = valid == 255;
  patch.bgr.setTo(cv::Scalar::all(0), patch.valid == 0);
  return patch.empty() ? MosaicPatch{} : patch;
}

// Reads the tiles `first` to `last` (inclusive) into one image; empty if the map has none of them.
cv::Mat MapMosaic::ReadTiles(const Eigen::Vector2i& first, const Eigen::Vector2i& last) const {
  const int side = layout_.tile_px;
  cv::Mat image;
  for (int y = first.y(); y <= last.y(); ++y) {
    for (int x = first.x(); x <= last.x(); ++x) {
      const auto jpeg = map_.ReadMosaicTile({layout_.max_zoom, x, y});
      if (!jpeg) {
        continue;
      }
      const cv::Mat tile = DecodeMosaicTile(*jpeg, side);
      if (image.empty()) {
        image = cv::Mat::zeros((last.y() - first.y() + 1) * side, (last.x() - first.x() + 1) * side, CV_8UC3);
      }
      tile.copyTo(image(cv::Rect((x - first.x()) * side, (last.y() - y) * side, side, side)));
    }
  }
  return image;
}

}  // namespace floorloc
