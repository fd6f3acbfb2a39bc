// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/detectors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>

#include "core/vision/freak_star/star.h"
#include "core/vision/surf/surf.h"
#include "mapbuilder/laboratory/contour_shapes.h"

namespace floorloc {
namespace {

constexpr int kAll = 1'000'000;  // OpenCV's "no limit"

// Size of corners in px: they have none, but descriptors need one.
constexpr float kCornerSizePx = 9.0F;

// MSER fits ellipses to its regions, of which some are degenerate and some unbounded. With sizes near 0 px, SIFT of
// OpenCV 4.6 writes out of bounds.
bool HasUsableSize(const cv::KeyPoint& k) {
  constexpr float kSmallestPx = 3.0F;
  constexpr float kLargestPx = 150.0F;
  return k.size >= kSmallestPx && k.size <= kLargestPx;
}

// Direction from the keypoint to the intensity centroid of the disc around it (Rosin 1999), degrees clockwise.
float CentroidAngle(const cv::Mat& gray, const cv::Point2f& position) {
  constexpr int kRadius = 12;
  const cv::Point middle(cvRound(position.x), cvRound(position.y));
  double moment_x = 0.0;
  double moment_y = 0.0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      const cv::Point pixel(middle.x + dx, middle.y + dy);
      if (dx * dx + dy * dy <= kRadius * kRadius && pixel.x >= 0 && pixel.y >= 0 && pixel.x < gray.cols &&
          pixel.y < gray.rows) {
        moment_x += dx * gray.at<std::uint8_t>(pixel);
        moment_y += dy * gray.at<std::uint8_t>(pixel);
      }
    }
  }
  return cv::fastAtan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

class OpenCvDetector final : public Detector {
 public:
  OpenCvDetector(cv::Ptr<cv::Feature2D> feature, DetectorKind kind) : feature_(std::move(feature)), kind_(kind) {}

  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const override {
    std::vector<cv::KeyPoint> keypoints;
    feature_->detect(gray, keypoints, mask);
    if (kind_ == DetectorKind::kMser) {
      std::erase_if(keypoints, [](const cv::KeyPoint& k) { return !HasUsableSize(k); });
    }
    for (cv::KeyPoint& k : keypoints) {
      if (kind_ == DetectorKind::kHarris || kind_ == DetectorKind::kShiTomasi || kind_ == DetectorKind::kFast) {
        k.size = kCornerSizePx;
      }
      if (kind_ == DetectorKind::kMser) {
        k.response = k.size;  // the detector gives no response
      }
      if (k.angle < 0.0F) {
        k.angle = CentroidAngle(gray, k.pt);
      }
    }
    return keypoints;
  }

 private:
  cv::Ptr<cv::Feature2D> feature_;
  DetectorKind kind_;
};

class SurfDetector final : public Detector {
 public:
  explicit SurfDetector(const SurfOptions& options) : surf_(options) {}
  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const override {
    return surf_.Detect(gray, mask);
  }

 private:
  Surf surf_;
};

class StarDetector final : public Detector {
 public:
  explicit StarDetector(const StarOptions& options) : star_(options) {}
  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const override {
    std::vector<cv::KeyPoint> keypoints = star_.Detect(gray, mask);
    for (cv::KeyPoint& k : keypoints) {
      k.angle = CentroidAngle(gray, k.pt);
    }
    return keypoints;
  }

 private:
  Star star_;
};

class ContourDetector final : public Detector {
 public:
  std::vector<cv::KeyPoint> Detect(const cv::Mat& gray, const cv::Mat& mask) const override {
    std::vector<cv::KeyPoint> keypoints;
    for (const ContourShape& shape : FindContourShapes(gray)) {
      const cv::Point pixel(static_cast<int>(shape.keypoint.pt.x), static_cast<int>(shape.keypoint.pt.y));
      if (mask.at<std::uint8_t>(pixel) != 0) {
        keypoints.push_back(shape.keypoint);
      }
    }
    return keypoints;
  }
};

cv::Ptr<cv::Feature2D> CreateOpenCvDetector(DetectorKind kind, bool thesis) {
  switch (kind) {
    case DetectorKind::kSift:
      return thesis ? cv::SIFT::create() : cv::SIFT::create(0, 3, 0.02);
    case DetectorKind::kOrb:
      return thesis ? cv::ORB::create(kAll) : cv::ORB::create(kAll, 1.4F, 2, 19);
    case DetectorKind::kBrisk:
      return thesis ? cv::BRISK::create() : cv::BRISK::create(20, 2);
    case DetectorKind::kMser:
      return thesis ? cv::MSER::create() : cv::MSER::create(3, 25, 2500);
    case DetectorKind::kAkaze:
      return thesis ? cv::AKAZE::create() : cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, 0.0005F, 2);
    case DetectorKind::kHarris:
      return cv::GFTTDetector::create(kAll, 0.01, 2.0, 3, true);
    case DetectorKind::kShiTomasi:
      return cv::GFTTDetector::create(kAll, 0.01, 2.0);
    case DetectorKind::kFast:
      return cv::FastFeatureDetector::create(thesis ? 10 : 20);
    case DetectorKind::kSurf:
    case DetectorKind::kStar:
    case DetectorKind::kContour:
      break;
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<Detector> CreateDetector(DetectorKind kind, DetectorSettings settings) {
  const bool thesis = settings == DetectorSettings::kThesis;
  if (kind == DetectorKind::kSurf) {
    SurfOptions options;
    if (thesis) {
      options.threshold = 200.0;
      options.octaves = 4;
      options.layers = 3;
    }
    return std::make_unique<SurfDetector>(options);
  }
  if (kind == DetectorKind::kStar) {
    return std::make_unique<StarDetector>(StarOptions());
  }
  if (kind == DetectorKind::kContour) {
    return std::make_unique<ContourDetector>();
  }
  return std::make_unique<OpenCvDetector>(CreateOpenCvDetector(kind, thesis), kind);
}

}  // namespace floorloc
