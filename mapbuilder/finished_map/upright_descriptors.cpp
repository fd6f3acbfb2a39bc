// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/upright_descriptors.h"

#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "core/map/keypoint_blobs.h"
#include "core/vision/extractors/extractor_layout.h"
#include "core/vision/extractors/steered_brief.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr double kBlockM = 1.0;
// Beyond a block: the support of a descriptor and of the smoothing before it.
constexpr int kMarginPx = 2 * kBriefReachPx;

constexpr double kUnknownGray = 128.0;  // the mean of a contrast-normalised image

// The mosaic as an image of a robot that looks along the map's +y, as a rectified image is: +x of its base is up.
constexpr double kYawOfMosaic = std::numbers::pi / 2.0;

struct MosaicView {
  GroundGrid grid;
  cv::Mat prepared;
};

MosaicView ViewOf(const MosaicRaster& raster, const RectM& rect, double resolution_m) {
  const RasterPatch patch = raster.Cut(rect);
  cv::Mat gray = patch.gray.clone();
  gray.setTo(kUnknownGray, patch.gray == 0);
  const double scale = patch.resolution_m / resolution_m;
  if (std::abs(scale - 1.0) > 1e-6) {
    cv::resize(gray, gray, cv::Size(), scale, scale, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  }
  // cv::resize keeps the corner of the image, not the centre of its first pixel.
  const double shift_m = 0.5 * (resolution_m - patch.resolution_m);
  return {{patch.y_top_m - shift_m, -(patch.x_left_m + shift_m), resolution_m, gray.cols, gray.rows}, gray};
}

}  // namespace

cv::Mat DescribeInMosaic(const MapKeypoints& keypoints, const FinishedMosaic& mosaic, const RunOptions& run) {
  // Half a percent more: resolutions are rounded when maps are written.
  const bool fine = mosaic.layout.resolution_m <= 1.005 * mosaic.max_coarseness * mosaic.resolution_m;
  if (!fine || !HasUpright(mosaic.extractor.type)) {
    return {};
  }
  const std::unique_ptr<FeatureExtractor> extractor = CreateFeatureExtractor(mosaic.extractor);
  std::mutex reading;
  const MosaicRaster raster(
      [&](const TileId& tile) {
        const std::scoped_lock lock(reading);
        return mosaic.tiles(tile);
      },
      mosaic.layout, ContrastOfMosaic(mosaic.extractor), std::size_t{64} << 20);
  const auto by_block = KeypointsByTile(keypoints, kBlockM);
  const std::vector<std::pair<std::pair<int, int>, std::vector<int>>> blocks(by_block.begin(), by_block.end());
  cv::Mat upright(static_cast<int>(keypoints.size()), kBriefBytes, CV_8UC1);
  ParallelFor(static_cast<int>(blocks.size()), run.threads, [&](int b) {
    const auto& [block, indices] = blocks[static_cast<std::size_t>(b)];
    const double margin_m = kMarginPx * mosaic.resolution_m;
    const MosaicView view = ViewOf(raster,
                                   {block.first * kBlockM - margin_m, (block.first + 1) * kBlockM + margin_m,
                                    block.second * kBlockM - margin_m, (block.second + 1) * kBlockM + margin_m},
                                   mosaic.resolution_m);
    std::vector<Keypoint> in_view;
    for (const int i : indices) {
      const Eigen::Vector2d p = keypoints.PositionInMap(static_cast<std::size_t>(i));
      Keypoint k;
      k.x_m = static_cast<float>(p.y() - view.grid.x_top_m);
      k.y_m = static_cast<float>(-p.x() - view.grid.y_left_m);
      in_view.push_back(k);
    }
    // Relative to the view's corner: coordinates far from the map's origin are too large for float32.
    GroundGrid grid = view.grid;
    grid.x_top_m = 0.0;
    grid.y_left_m = 0.0;
    const cv::Mat rows = DescribeUpright(extractor->MakeUpright(grid, view.prepared), in_view, kYawOfMosaic);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      rows.row(static_cast<int>(k)).copyTo(upright.row(indices[k]));
    }
  });
  return upright;
}

}  // namespace floorloc
