// SPDX-License-Identifier: Apache-2.0
#include "core/localization/partial_view.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "mapbuilder/simulation/simulated_camera.h"

namespace floorloc {
namespace {

FloorCamera CameraAt(double height_m) { return MakeDownwardCamera(height_m).AtResolution(7e-4); }

double AreaOf(const FloorCamera& camera) { return camera.floor.roi.width_m() * camera.floor.roi.height_m(); }

const Rectifier& HighView() {
  static const Rectifier rectifier(CameraAt(0.8));
  return rectifier;
}

ViewParts PartsOf(const Rectifier& rectifier, const PartialViewOptions& options = {}) {
  return ChooseViewParts(rectifier, AreaOf(CameraAt(0.4)), options);
}

cv::Mat Noise(const CameraModel& camera) {
  cv::Mat raw(camera.height_px, camera.width_px, CV_8UC1);
  cv::theRNG().state = 5;
  cv::randu(raw, 0, 256);
  cv::GaussianBlur(raw, raw, {}, 2.0);
  return raw;
}

TEST(PartialViewTest, AViewLikeTheMapsIsLookedAtAsAWhole) {
  EXPECT_TRUE(PartsOf(Rectifier(CameraAt(0.4))).keypoints.empty());
  EXPECT_TRUE(PartsOf(Rectifier(CameraAt(0.5))).keypoints.empty());
  EXPECT_TRUE(PartsOf(HighView(), {.max_views = 0.0}).keypoints.empty()) << "switched off";
}

TEST(PartialViewTest, KeypointsAreSearchedInTheMiddleAndTheRestIsSampledAllOver) {
  const ViewParts parts = PartsOf(HighView());
  const cv::Size whole = HighView().mask().size();
  EXPECT_NEAR(parts.keypoints.area() / static_cast<double>(whole.area()), 0.25, 0.05);
  const cv::Point middle = (parts.keypoints.tl() + parts.keypoints.br()) / 2;
  EXPECT_NEAR(middle.x, whole.width / 2, 48);
  EXPECT_NEAR(middle.y, whole.height / 2, 48);
  ASSERT_FALSE(parts.outer.empty());
  cv::Rect all = parts.keypoints;
  for (const cv::Rect& patch : parts.outer) {
    EXPECT_TRUE((patch & parts.keypoints).empty());
    all |= patch;
  }
  EXPECT_GT(all.area(), 0.7 * whole.area()) << "the lever is that of the whole view";
}

TEST(PartialViewTest, KeypointsAreNotSearchedWhereTheRobotIs) {
  const FloorCamera camera = CameraAt(0.8);
  cv::Mat mask(camera.camera.height_px, camera.camera.width_px, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 0, mask.cols * 4 / 10, mask.rows)).setTo(0);
  const Rectifier rectifier(camera, mask);
  const ViewParts parts = PartsOf(rectifier);
  EXPECT_EQ(cv::countNonZero(rectifier.mask()(parts.keypoints)), parts.keypoints.area());
}

TEST(PartialViewTest, ThePartsAreThoseOfTheWhole) {
  const Rectifier& rectifier = HighView();
  const cv::Mat raw = Noise(rectifier.camera().camera);
  const auto extractor = CreateFeatureExtractor({});
  const GroundImage whole = rectifier.Rectify(raw);
  const cv::Mat prepared = extractor->Prepare(whole);
  const ViewParts parts = PartsOf(rectifier);
  const PartialView view = RectifyParts(rectifier, raw, parts, {*extractor});
  EXPECT_EQ(cv::norm(view.keypoint_image.gray, whole.gray(parts.keypoints), cv::NORM_INF), 0.0);
  const Eigen::Vector2d corner = whole.grid.BaseFromPixel(parts.keypoints.x, parts.keypoints.y);
  EXPECT_NEAR((view.keypoint_image.grid.BaseFromPixel(0, 0) - corner).norm(), 0.0, 1e-12);
  int known = parts.keypoints.area();
  for (const cv::Rect& patch : parts.outer) {
    EXPECT_LE(cv::norm(view.prepared(patch), prepared(patch), cv::NORM_INF), 1.0) << patch;
    known += patch.area();
  }
  EXPECT_EQ(cv::countNonZero(view.image.mask), known) << "nothing is known of the rest";
}

TEST(PartialViewTest, BadOptionsAreRefused) {
  EXPECT_THROW(PartialViewOptions{.max_views = -1.0}.Check(), std::invalid_argument);
  EXPECT_THROW(PartialViewOptions{.keypoint_views = 0.0}.Check(), std::invalid_argument);
  EXPECT_THROW(PartialViewOptions{.outer_cells = -1}.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
