// SPDX-License-Identifier: Apache-2.0
#include "server/serving/inspection.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace floorloc {
namespace {

constexpr int kPngLevel = 1;  // zlib's fastest: noise does not shrink by more

// From pixel edge to pixel edge.
RectM RegionOf(const GroundGrid& grid) {
  const Eigen::Vector2d low = grid.BaseFromPixel(grid.width_px - 0.5, grid.height_px - 0.5);
  const Eigen::Vector2d high = grid.BaseFromPixel(-0.5, -0.5);
  return {low.x(), high.x(), low.y(), high.y()};
}

}  // namespace

Inspection Inspect(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                   const ObservedFrame& frame) {
  const FrameObservation& observation = frame.observation;
  // Of a large view that was localized by a part of it, the whole is shown.
  const GroundImage floor = observation.floor.gray.empty() ? rectifier.Rectify(raw) : observation.floor;
  const GroundImage seen = LeaveOut(floor, observation.left_out);
  Inspection inspection;
  inspection.region = RegionOf(floor.grid);
  cv::Mat bgra;
  cv::merge(std::vector<cv::Mat>{floor.gray, floor.gray, floor.gray, seen.mask}, bgra);
  cv::imencode(".png", bgra, inspection.image, {cv::IMWRITE_PNG_COMPRESSION, kPngLevel});
  for (const Keypoint& keypoint : observation.features.keypoints) {
    inspection.keypoints.push_back(keypoint.Position());
  }
  inspection.poses = localizer.Compete(observation, frame.result, Inspection::kMaxPoses);
  return inspection;
}

}  // namespace floorloc
