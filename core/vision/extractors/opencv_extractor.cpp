// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/opencv_extractor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/vision/extractors/surf_feature.h"
#include "core/vision/features/keypoint_angle.h"
#include "core/vision/features/spread.h"

namespace floorloc {
namespace {

double DefaultThreshold(ExtractorType type) {
  switch (type) {
    case ExtractorType::kOrb:
      return 30.0;  // FAST, grey levels
    case ExtractorType::kSift:
      return 0.02;  // contrast
    case ExtractorType::kAkaze:
      return 0.0005;  // determinant of the Hessian
    case ExtractorType::kBrisk:
      return 20.0;  // AGAST, grey levels
    case ExtractorType::kSurf:
      return 30.0;  // determinant of the Hessian
    case ExtractorType::kHessian:
      break;  // not OpenCV's
  }
  return 0.0;
}

cv::Ptr<cv::Feature2D> CreateDetector(const ExtractorOptions& o) {
  const double threshold = o.threshold > 0.0 ? o.threshold : DefaultThreshold(o.type);
  // Detects more than is kept, so that the kept ones can be spread evenly.
  const int detected = 2 * o.max_keypoints;
  switch (o.type) {
    case ExtractorType::kOrb:
      return cv::ORB::create(detected, static_cast<float>(o.scale_factor), o.levels, 19, 0, 2, cv::ORB::HARRIS_SCORE,
                             31, static_cast<int>(threshold));
    case ExtractorType::kSift:
      return cv::SIFT::create(o.max_keypoints, 3, threshold, 10.0, 1.6);
    case ExtractorType::kAkaze:
      return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, static_cast<float>(threshold), o.levels, 4,
                               cv::KAZE::DIFF_PM_G2);
    case ExtractorType::kBrisk:
      return cv::BRISK::create(static_cast<int>(threshold), o.levels);
    case ExtractorType::kSurf:
      return CreateSurfFeature({.threshold = threshold, .octaves = o.levels});
    case ExtractorType::kHessian:
      break;  // not OpenCV's
  }
  throw std::invalid_argument("unknown extractor");
}

// Size of a pyramid level as OpenCV 4.6 makes it: sides are rounded or cut off to whole pixels.
cv::Size LevelSize(const ExtractorOptions& o, const cv::Size& image_size, int level) {
  if (o.type == ExtractorType::kOrb) {
    const double factor = std::pow(o.scale_factor, level);
    return {cvRound(image_size.width / factor), cvRound(image_size.height / factor)};
  }
  if (o.type == ExtractorType::kBrisk) {  // layers alternate: the image or two thirds of it, each halved repeatedly
    const bool thirds = level % 2 == 1;
    const cv::Size first = thirds ? cv::Size(image_size.width / 3 * 2, image_size.height / 3 * 2) : image_size;
    return {first.width >> (level / 2), first.height >> (level / 2)};
  }
  return {image_size.width >> level, image_size.height >> level};
}

// OpenCV throws on images whose smallest level would be empty.
bool FitsPyramid(const ExtractorOptions& o, const cv::Size& image_size) {
  constexpr int kMinSidePx = 8;
  const int smallest = o.type == ExtractorType::kOrb     ? o.levels - 1
                       : o.type == ExtractorType::kBrisk ? 2 * o.levels - 1
                                                         : 0;
  const cv::Size size = LevelSize(o, image_size, smallest);
  return std::min(size.width, size.height) >= kMinSidePx;
}

// Factor by which OpenCV scales up the keypoints of a level.
double NominalFactor(const ExtractorOptions& o, int level) {
  if (o.type == ExtractorType::kOrb) {
    return std::pow(o.scale_factor, level);
  }
  if (o.type == ExtractorType::kBrisk) {
    return (level % 2 == 1 ? 1.5 : 1.0) * (1 << (level / 2));
  }
  return 1 << level;
}

// True position of a keypoint, px. OpenCV 4.6 scales the coordinates of a pyramid's keypoints by the nominal factor of
// the level, not by the ratio of the sizes, which errs by half a pixel and more; ORB also ignores the half-pixel offset
// of pixel centres. SIFT is off by a constant. Measured by matching images with themselves rotated by 180 degrees
// (tests/core/vision).
Eigen::Vector2d CorrectedPixel(const ExtractorOptions& o, const cv::Size& image_size, const cv::KeyPoint& k) {
  Eigen::Vector2d reported(k.pt.x, k.pt.y);
  if (o.type == ExtractorType::kSift) {
    return reported.array() - 0.25;
  }
  if (o.type == ExtractorType::kSurf) {
    return reported;  // no pyramid: every octave is computed from the image itself
  }
  const double factor = NominalFactor(o, k.octave);
  const cv::Size level = LevelSize(o, image_size, k.octave);
  const Eigen::Vector2d from_edge = o.type == ExtractorType::kOrb ? Eigen::Vector2d(reported.array() / factor + 0.5)
                                                                  : Eigen::Vector2d((reported.array() + 0.5) / factor);
  return {from_edge.x() * image_size.width / level.width - 0.5, from_edge.y() * image_size.height / level.height - 0.5};
}

// Radius of the support of orientation and descriptor, px: keypoints nearer to masked pixels are dropped.
float SupportRadius(ExtractorType type, const cv::KeyPoint& keypoint) {
  switch (type) {
    case ExtractorType::kOrb:
      return 0.5F * keypoint.size;
    case ExtractorType::kSift:
    case ExtractorType::kAkaze:
      return 2.0F * keypoint.size;
    case ExtractorType::kBrisk:
      return keypoint.size;
    case ExtractorType::kSurf:
      return SurfReachPx(keypoint);
    case ExtractorType::kHessian:
      break;  // not OpenCV's
  }
  return keypoint.size;
}

// Drops keypoints whose support reaches masked pixels, where floor changes to grey. The edge of the image is not a mask
// edge.
std::vector<cv::KeyPoint> DropNearMaskEdge(ExtractorType type, const cv::Mat& mask,
                                           std::vector<cv::KeyPoint> keypoints) {
  if (cv::countNonZero(mask) == mask.rows * mask.cols) {
    return keypoints;
  }
  cv::Mat distance;
  cv::distanceTransform(mask, distance, cv::DIST_L2, 3);
  std::erase_if(keypoints, [&](const cv::KeyPoint& k) {
    return distance.at<float>(static_cast<int>(k.pt.y), static_cast<int>(k.pt.x)) < SupportRadius(type, k);
  });
  return keypoints;
}

Keypoint ToFloor(const ExtractorOptions& options, const GroundGrid& grid, const cv::KeyPoint& k) {
  const Eigen::Vector2d pixel = CorrectedPixel(options, {grid.width_px, grid.height_px}, k);
  const Eigen::Vector2d p = grid.BaseFromPixel(pixel.x(), pixel.y());
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), BaseAngle(k.angle),
          static_cast<float>(k.size * grid.resolution_m), k.response};
}

class OpenCvExtractor final : public FeatureExtractor {
 public:
  explicit OpenCvExtractor(const ExtractorOptions& options)
      : FeatureExtractor(options), detector_(CreateDetector(options)) {}

  UprightImage MakeUpright(const GroundGrid& /*grid*/, const cv::Mat& /*prepared*/) const override { return {}; }
  Features Extract(const GroundImage& image, const cv::Mat& prepared, UprightImage* /*upright*/) const override {
    if (!FitsPyramid(options(), image.gray.size())) {
      return {};
    }
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    if (DescribesWhileDetecting()) {
      detector_->detectAndCompute(prepared, cv::noArray(), keypoints, descriptors);
      Select(image, &keypoints, &descriptors);
    } else {
      detector_->detect(prepared, keypoints);
      Select(image, &keypoints, nullptr);
      detector_->compute(prepared, keypoints, descriptors);
    }
    Features features;
    features.keypoints.reserve(keypoints.size());
    for (const cv::KeyPoint& k : keypoints) {
      features.keypoints.push_back(ToFloor(options(), image.grid, k));
    }
    features.descriptors = descriptors;
    return features;
  }

  DescriptorType descriptor_type() const override {
    return detector_->descriptorType() == CV_32F ? DescriptorType::kFloat : DescriptorType::kBinary;
  }
  int descriptor_length() const override { return detector_->descriptorSize(); }

 private:
  // SIFT and AKAZE build an expensive scale space that detection and description share.
  bool DescribesWhileDetecting() const {
    return options().type == ExtractorType::kSift || options().type == ExtractorType::kAkaze;
  }

  void Select(const GroundImage& image, std::vector<cv::KeyPoint>* keypoints, cv::Mat* descriptors) const {
    std::vector<cv::KeyPoint> numbered = *keypoints;
    for (std::size_t i = 0; i < numbered.size(); ++i) {
      numbered[i].class_id = static_cast<int>(i);
    }
    numbered = DropNearMaskEdge(options().type, image.mask, std::move(numbered));
    std::vector<cv::KeyPoint> selected;
    cv::Mat selected_descriptors;
    for (const int i : SpreadEvenly(numbered, options().cell_px, options().max_keypoints)) {
      selected.push_back(numbered[static_cast<std::size_t>(i)]);
      if (descriptors != nullptr) {
        selected_descriptors.push_back(descriptors->row(selected.back().class_id));
      }
    }
    *keypoints = std::move(selected);
    if (descriptors != nullptr) {
      *descriptors = selected_descriptors;
    }
  }

  cv::Ptr<cv::Feature2D> detector_;  // detect and compute keep no state between calls
};

}  // namespace

std::unique_ptr<FeatureExtractor> CreateOpenCvExtractor(const ExtractorOptions& options) {
  return std::make_unique<OpenCvExtractor>(options);
}

}  // namespace floorloc
