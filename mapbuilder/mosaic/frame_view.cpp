// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/frame_view.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace floorloc {
namespace {

// Stands for all positions outside the image.
constexpr float kFarOutsidePx = -1e6F;

cv::Mat DepthOf(const cv::Mat& mask) {
  cv::Mat framed;
  cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat depth;
  cv::distanceTransform(framed, depth, cv::DIST_L2, 3);
  return depth(cv::Rect(1, 1, mask.cols, mask.rows)).clone();
}

}  // namespace

SurveyView::SurveyView(const LoadedSurvey& survey, cv::Mat gain)
    : rectifier(survey.rectifier), depth(DepthOf(survey.rectifier->mask())), flat_gain(std::move(gain)) {}

FrameView::FrameView(const SurveyView& survey, const Pose2& map_from_base, const BuildFrame& frame)
    : survey_(&survey),
      map_from_base_(Eigen::Translation2d(map_from_base.translation()) * Eigen::Rotation2Dd(map_from_base.yaw())),
      camera_center_(survey.rectifier->camera().CameraCenter()) {
  if (frame.height_ratio != 1.0) {
    const Eigen::Vector2d below = camera_center_.head<2>();
    map_from_base_ = map_from_base_ * Eigen::Translation2d(below) * Eigen::Scaling(frame.height_ratio) *
                     Eigen::Translation2d(-below);
  }
  base_from_map_ = map_from_base_.inverse();
  readout_motion_ = frame.readout_motion;
  mounting_error_ << frame.mounting_error.rotation_rad, frame.mounting_error.height_share;
}

cv::Rect FrameView::Footprint(const MosaicGrid& grid) const {
  const RectM& roi = survey_->rectifier->camera().floor.roi;
  Eigen::AlignedBox2d box;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      box.extend(grid.NodeFromMap(map_from_base_ * Eigen::Vector2d(x, y)));
    }
  }
  const Eigen::Vector2i first = box.min().array().floor().cast<int>();
  const Eigen::Vector2i last = box.max().array().ceil().cast<int>();
  return cv::Rect(first.x(), first.y(), last.x() - first.x() + 1, last.y() - first.y() + 1) & grid.AllNodes();
}

float FrameView::BorderPx(const MosaicGrid& grid) const {
  constexpr double kDiagonal = 1.5;
  return static_cast<float>(kDiagonal * MosaicGrid::kCellPx * grid.step_m() / survey_->rectifier->grid().resolution_m);
}

float FrameView::SampleRectified(const cv::Mat& image, const Eigen::Vector2d& point_in_map, float outside) const {
  const Eigen::Vector2d px = survey_->rectifier->grid().PixelFromBase(base_from_map_ * point_in_map);
  const auto u = static_cast<int>(std::lround(px.x()));
  const auto v = static_cast<int>(std::lround(px.y()));
  return u >= 0 && v >= 0 && u < image.cols && v < image.rows ? image.at<float>(v, u) : outside;
}

float FrameView::Depth(const Eigen::Vector2d& point_in_map) const {
  return SampleRectified(survey_->depth, point_in_map, 0.0F);
}

float FrameView::FlatGain(const Eigen::Vector2d& point_in_map) const {
  return SampleRectified(survey_->flat_gain, point_in_map, 1.0F);
}

cv::Vec2f FrameView::RawPixel(const Eigen::Vector2d& point_in_map) const {
  const Eigen::Vector2d in_base = base_from_map_ * point_in_map;
  // Where the calibrated camera would see the point that the displaced one sees here.
  const Eigen::Vector2d calibrated = in_base - MountingJacobian(camera_center_, in_base) * mounting_error_;
  const Eigen::Vector2d raw = RawPixelWhileMoving(survey_->rectifier->camera(), calibrated, readout_motion_);
  if (!raw.allFinite()) {
    return {kFarOutsidePx, kFarOutsidePx};
  }
  const Eigen::Vector2f px = raw.cast<float>().cwiseMax(kFarOutsidePx).cwiseMin(-kFarOutsidePx);
  return {px.x(), px.y()};
}

}  // namespace floorloc
