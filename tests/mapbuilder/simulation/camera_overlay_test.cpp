// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/camera_overlay.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "mapbuilder/simulation/render_conditions.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

const cv::Size kSize(640, 480);

double ShareOf(const cv::Mat& region) { return cv::countNonZero(region) / static_cast<double>(region.total()); }

OverlayOptions Overlay(OverlayKind kind, double share) {
  OverlayOptions options;
  options.kind = kind;
  options.share = share;
  return options;
}

TEST(OverlayKind, HasNamesThatAreParsed) {
  for (const std::string& name : OverlayKindNames()) {
    EXPECT_EQ(ToString(ParseOverlayKind(name)), name);
  }
  EXPECT_THROW(ParseOverlayKind("wheel"), std::invalid_argument);
}

TEST(OverlayOptions, RefusesAnImageWithoutFloor) {
  EXPECT_THROW(CameraOverlay(Overlay(OverlayKind::kPart, 1.0), kSize), std::invalid_argument);
  OverlayOptions swaying = Overlay(OverlayKind::kPart, 0.1);
  swaying.sway_px = -1.0;
  EXPECT_THROW(CameraOverlay(swaying, kSize), std::invalid_argument);
}

TEST(CameraOverlay, CoversItsShareOfTheImage) {
  for (const std::string& name : OverlayKindNames()) {
    for (const double share : {0.05, 0.13, 0.3}) {
      const CameraOverlay overlay(Overlay(ParseOverlayKind(name), share), kSize);
      EXPECT_NEAR(ShareOf(overlay.region()), share, 0.01) << name;
    }
  }
}

TEST(CameraOverlay, ChangesItsRegionOnly) {
  for (const std::string& name : OverlayKindNames()) {
    const CameraOverlay overlay(Overlay(ParseOverlayKind(name), 0.13), kSize);
    cv::Mat image(kSize, CV_32FC1, cv::Scalar::all(100.0));
    overlay.CoverScene(Eigen::Vector2d::Zero(), &image);
    overlay.BurnIn(1.0, &image);
    cv::Mat around;
    cv::dilate(overlay.region(), around, cv::Mat::ones(13, 13, CV_8UC1));
    const cv::Mat changed = cv::abs(image - 100.0) > 2.0;
    EXPECT_EQ(cv::countNonZero(changed & ~around), 0) << name;
    EXPECT_GT(cv::countNonZero(changed), cv::countNonZero(overlay.region()) / 2) << name;
  }
}

TEST(CameraOverlay, SwaysWithoutChangingItsLook) {
  const CameraOverlay overlay(Overlay(OverlayKind::kPart, 0.13), kSize);
  cv::Mat still(kSize, CV_32FC1, cv::Scalar::all(100.0));
  cv::Mat swayed = still.clone();
  overlay.CoverScene({0.0, 0.0}, &still);
  overlay.CoverScene({3.0, -2.0}, &swayed);
  const cv::Rect inside(20, 400, 80, 60);
  EXPECT_LT(cv::norm(still(inside), swayed(inside + cv::Point(3, -2)), cv::NORM_INF), 1e-3);
  EXPECT_GT(cv::norm(still(inside), swayed(inside), cv::NORM_INF), 20.0);
}

TEST(CameraOverlay, StampsTheTime) {
  const CameraOverlay overlay(Overlay(OverlayKind::kText, 0.05), kSize);
  cv::Mat first(kSize, CV_32FC1, cv::Scalar::all(100.0));
  cv::Mat second = first.clone();
  overlay.BurnIn(1.0, &first);
  overlay.BurnIn(2.0, &second);
  const cv::Mat changed = cv::abs(first - second) > 1.0;
  EXPECT_GT(cv::countNonZero(changed), 10);
  EXPECT_LT(cv::countNonZero(changed), cv::countNonZero(overlay.region()) / 10) << "only the digits change";
}

// What a mask is made for: the same pixels in each image of the camera, while the floor moves.
TEST(ConditionSampler, ShowsTheSameOverlayInAllFramesAndRecordings) {
  const SyntheticFloor floor;
  ConditionLevels levels;
  levels.overlay = Overlay(OverlayKind::kPart, 0.13);
  const FloorTexture size{cv::Mat(10, 10, CV_8UC3), 0.1};
  const ConditionSampler survey(levels, size, floor.camera(), 1);
  const ConditionSampler drive(levels, size, floor.camera(), 2);
  const RenderConditions first = survey.Sample(0, 0.0, Eigen::Vector3d::Zero());
  const RenderConditions later = drive.Sample(7, 3.0, Eigen::Vector3d(0.3, 0.0, 0.0));
  ASSERT_TRUE(first.overlay);
  cv::Mat difference;
  cv::absdiff(floor.View(floor.BaseForView(0.5, 0.4, 0.0), first), floor.View(floor.BaseForView(0.7, 0.5, 1.0), later),
              difference);
  cv::cvtColor(difference, difference, cv::COLOR_BGR2GRAY);
  cv::Mat inside;
  cv::erode(first.overlay->region(), inside, cv::Mat::ones(7, 7, CV_8UC1));
  EXPECT_LT(cv::mean(difference, inside)[0], 0.5);
  EXPECT_GT(cv::mean(difference, ~first.overlay->region())[0], 3.0);
}

TEST(ConditionSampler, HasNoOverlayUnlessAskedFor) {
  const SyntheticFloor floor;
  for (const char* name : {"clean", "mild", "hard"}) {
    const ConditionSampler sampler(ConditionLevels::FromName(name), {cv::Mat(10, 10, CV_8UC3), 0.1}, floor.camera(), 1);
    EXPECT_FALSE(sampler.Sample(0, 0.0, Eigen::Vector3d::Zero()).overlay) << name;
  }
}

}  // namespace
}  // namespace floorloc
