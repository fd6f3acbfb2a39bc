// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/surf_feature.h"

#include "core/vision/features/keypoint_selection.h"

namespace floorloc {
namespace {

class SurfFeature final : public cv::Feature2D {
 public:
  explicit SurfFeature(const SurfOptions& options) : surf_(options) {}

  void detect(cv::InputArray image, std::vector<cv::KeyPoint>& keypoints, cv::InputArray mask) override {
    const cv::Mat gray = image.getMat();
    keypoints = surf_.Find(IntegralImage(gray), mask.empty() ? cv::Mat() : mask.getMat());
    DropNearEdge(gray.size(), SurfReachPx, &keypoints);
  }

  void compute(cv::InputArray image, std::vector<cv::KeyPoint>& keypoints, cv::OutputArray descriptors) override {
    surf_.Describe(image.getMat(), &keypoints).copyTo(descriptors);
  }

  int descriptorSize() const override { return kSurfLength; }
  int descriptorType() const override { return CV_32F; }
  int defaultNorm() const override { return cv::NORM_L2; }

 private:
  Surf surf_;
};

}  // namespace

cv::Ptr<cv::Feature2D> CreateSurfFeature(const SurfOptions& options) { return cv::makePtr<SurfFeature>(options); }

}  // namespace floorloc
