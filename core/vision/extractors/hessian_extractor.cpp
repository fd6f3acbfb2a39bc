// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/hessian_extractor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vision/extractors/hessian_detector.h"
#include "core/vision/extractors/steered_brief.h"
#include "core/vision/features/keypoint_angle.h"
#include "core/vision/features/spread.h"
#include "core/vision/image/gaussian.h"

namespace floorloc {
namespace {

// Scale of the blobs, in addition to the smoothing of the contrast normalisation: large enough to survive motion blur,
// small enough for many blobs.
constexpr double kSigmaPx = 2.5;

// Fixed-point steps per grey level of the smoothed image.
constexpr double kLevelSteps = 64.0;

constexpr double kDefaultThreshold = 0.05;

constexpr int kBorderPx = kBriefReachPx + 1;

bool IsInsideMask(const cv::Mat& mask, const cv::KeyPoint& k) {
  constexpr double kDiagonal = 0.7071;
  constexpr std::array<std::array<double, 2>, 9> kCompass{{{0, 0},
                                                           {1, 0},
                                                           {-1, 0},
                                                           {0, 1},
                                                           {0, -1},
                                                           {kDiagonal, kDiagonal},
                                                           {-kDiagonal, kDiagonal},
                                                           {kDiagonal, -kDiagonal},
                                                           {-kDiagonal, -kDiagonal}}};
  return std::all_of(kCompass.begin(), kCompass.end(), [&](const auto& direction) {
    return mask.at<std::uint8_t>(cvRound(static_cast<double>(k.pt.y) + kBriefReachPx * direction[1]),
                                 cvRound(static_cast<double>(k.pt.x) + kBriefReachPx * direction[0])) != 0;
  });
}

class HessianExtractor final : public FeatureExtractor {
 public:
  explicit HessianExtractor(const ExtractorOptions& options) : FeatureExtractor(options) {}

  Features Extract(const GroundImage& image, const cv::Mat& prepared, UprightImage* upright) const override {
    const cv::Mat smooth = SmoothGaussian(prepared, kSigmaPx);
    const double threshold = options().threshold > 0.0 ? options().threshold : kDefaultThreshold;
    std::vector<cv::KeyPoint> found = DetectHessian(smooth, kBorderPx, static_cast<float>(threshold));
    std::erase_if(found, [&](const cv::KeyPoint& k) { return !IsInsideMask(image.mask, k); });
    std::vector<cv::KeyPoint> keypoints;
    for (const int i : SpreadEvenly(found, options().cell_px, options().max_keypoints)) {
      keypoints.push_back(found[static_cast<std::size_t>(i)]);
    }
    OrientByCentroid(prepared, &keypoints);
    *upright = {image.grid, ToLevels(smooth)};
    return {ToFloor(image.grid, keypoints), DescribeBrief(upright->smooth, keypoints)};
  }
  UprightImage MakeUpright(const GroundGrid& grid, const cv::Mat& prepared) const override {
    return {grid, ToLevels(SmoothGaussian(prepared, kSigmaPx))};
  }

  DescriptorType descriptor_type() const override { return DescriptorType::kBinary; }
  int descriptor_length() const override { return kBriefBytes; }

 private:
  static cv::Mat ToLevels(const cv::Mat& smooth) {
    cv::Mat levels;
    smooth.convertTo(levels, CV_16S, kLevelSteps);
    return levels;
  }
  static std::vector<Keypoint> ToFloor(const GroundGrid& grid, const std::vector<cv::KeyPoint>& keypoints) {
    std::vector<Keypoint> on_floor;
    on_floor.reserve(keypoints.size());
    for (const cv::KeyPoint& k : keypoints) {
      const Eigen::Vector2f p =
          grid.BaseFromPixel(static_cast<double>(k.pt.x), static_cast<double>(k.pt.y)).cast<float>();
      on_floor.push_back(
          {p.x(), p.y(), BaseAngle(k.angle), static_cast<float>(2.0 * kBriefReachPx * grid.resolution_m), k.response});
    }
    return on_floor;
  }
};

}  // namespace

std::unique_ptr<FeatureExtractor> CreateHessianExtractor(const ExtractorOptions& options) {
  return std::make_unique<HessianExtractor>(options);
}

}  // namespace floorloc
