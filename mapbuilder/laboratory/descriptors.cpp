// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/descriptors.h"

#include <cassert>
#include <map>
#include <opencv2/features2d.hpp>
#include <utility>

#include "core/vision/freak_star/freak.h"
#include "core/vision/surf/surf.h"
#include "mapbuilder/laboratory/contour_shapes.h"

namespace floorloc {
namespace {

class OpenCvDescriptorExtractor final : public DescriptorExtractor {
 public:
  OpenCvDescriptorExtractor(cv::Ptr<cv::Feature2D> feature, bool same_family)
      : feature_(std::move(feature)), same_family_(same_family) {}

  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const override {
    if (!same_family_) {
      for (cv::KeyPoint& k : *keypoints) {
        k.octave = 0;
      }
    }
    cv::Mat descriptors;
    feature_->compute(gray, *keypoints, descriptors);
    return descriptors;
  }

 private:
  cv::Ptr<cv::Feature2D> feature_;
  bool same_family_;
};

class SurfDescriptorExtractor final : public DescriptorExtractor {
 public:
  SurfDescriptorExtractor() : surf_(SurfOptions()) {}
  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const override {
    return surf_.Describe(gray, keypoints);
  }

 private:
  Surf surf_;
};

class FreakDescriptorExtractor final : public DescriptorExtractor {
 public:
  FreakDescriptorExtractor() : freak_(FreakOptions()) {}
  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const override {
    return freak_.Describe(gray, keypoints);
  }

 private:
  Freak freak_;
};

// Assigns contours to keypoints by their centres, which are identical for the same image.
class HuDescriptorExtractor final : public DescriptorExtractor {
 public:
  cv::Mat Describe(const cv::Mat& gray, std::vector<cv::KeyPoint>* keypoints) const override {
    std::map<std::pair<float, float>, cv::Mat> by_centre;
    for (const ContourShape& shape : FindContourShapes(gray)) {
      by_centre[{shape.keypoint.pt.x, shape.keypoint.pt.y}] = cv::Mat(shape.hu).reshape(1, 1);
    }
    cv::Mat descriptors;
    for (const cv::KeyPoint& k : *keypoints) {
      descriptors.push_back(by_centre.at({k.pt.x, k.pt.y}));
    }
    return descriptors;
  }
};

}  // namespace

std::unique_ptr<DescriptorExtractor> CreateDescriptorExtractor(DetectorKind detector, DescriptorKind descriptor,
                                                               DetectorSettings settings) {
  assert(IncompatibilityReason(detector, descriptor).empty());
  const bool thesis = settings == DetectorSettings::kThesis;
  switch (descriptor) {
    case DescriptorKind::kSurf:
      return std::make_unique<SurfDescriptorExtractor>();
    case DescriptorKind::kSift:
      return std::make_unique<OpenCvDescriptorExtractor>(cv::SIFT::create(), detector == DetectorKind::kSift);
    case DescriptorKind::kOrb:
      return std::make_unique<OpenCvDescriptorExtractor>(thesis ? cv::ORB::create() : cv::ORB::create(500, 1.4F, 2, 19),
                                                         detector == DetectorKind::kOrb);
    case DescriptorKind::kBrisk:
      return std::make_unique<OpenCvDescriptorExtractor>(cv::BRISK::create(), detector == DetectorKind::kBrisk);
    case DescriptorKind::kFreak:
      return std::make_unique<FreakDescriptorExtractor>();
    case DescriptorKind::kAkaze:
      return std::make_unique<OpenCvDescriptorExtractor>(
          thesis ? cv::AKAZE::create() : cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, 0.0005F, 2), true);
    case DescriptorKind::kHu:
      return std::make_unique<HuDescriptorExtractor>();
  }
  return nullptr;
}

}  // namespace floorloc
