// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/tuned_feature.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <sstream>

#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

constexpr double kCountTolerance = 0.02;  // relative to the wanted number

// OpenCV's defaults, and the lower limits used when they give too few features.
constexpr double kOrbThreshold = 20.0;
constexpr double kSiftThreshold = 0.04;
constexpr double kMinOrbThreshold = 2.0;
constexpr double kMinSiftThreshold = 0.001;

struct Range {
  double low, high;
};

// Range of the threshold that is tuned per image.
Range ThresholdsOf(DetectorKind kind) {
  switch (kind) {
    case DetectorKind::kAkaze:
      return {1e-7, 0.1};
    case DetectorKind::kBrisk:
      return {1.0, 250.0};
    default:
      return {0.01, 1e5};  // SURF
  }
}

std::function<DescribedFeatures(const cv::Mat&)> WithOpenCv(const cv::Ptr<cv::Feature2D>& feature) {
  return [feature](const cv::Mat& gray) {
    DescribedFeatures found;
    feature->detectAndCompute(gray, cv::noArray(), found.keypoints, found.descriptors);
    return found;
  };
}

std::function<DescribedFeatures(const cv::Mat&)> WithSurf(double threshold) {
  SurfOptions options;
  options.threshold = threshold;
  options.octaves = 4;
  options.layers = 3;
  return [surf = Surf(options)](const cv::Mat& gray) {
    DescribedFeatures found;
    found.descriptors = surf.DetectAndDescribe(gray, cv::Mat(), &found.keypoints);
    return found;
  };
}

std::function<DescribedFeatures(const cv::Mat&)> Create(const FeatureSetting& setting) {
  const int whole_threshold = static_cast<int>(setting.threshold);
  switch (setting.kind) {
    case DetectorKind::kOrb:
      return WithOpenCv(
          cv::ORB::create(setting.max_features, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, whole_threshold));
    case DetectorKind::kSift:
      return WithOpenCv(cv::SIFT::create(setting.max_features, 3, setting.threshold));
    case DetectorKind::kBrisk:
      return WithOpenCv(cv::BRISK::create(whole_threshold));
    case DetectorKind::kAkaze:
      return WithOpenCv(cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, static_cast<float>(setting.threshold)));
    default:
      assert(setting.kind == DetectorKind::kSurf);
      return WithSurf(setting.threshold);
  }
}

int Count(const FeatureSetting& setting, const cv::Mat& gray) {
  return static_cast<int>(TunedFeature(setting).DetectAndDescribe(gray).keypoints.size());
}

// Keeps the strongest `wanted` features; lowers the threshold until there are enough.
FeatureSetting KeepStrongest(FeatureSetting setting, const cv::Mat& gray, double least_threshold) {
  constexpr double kStep = 0.7;
  while (Count(setting, gray) < (1.0 - kCountTolerance) * setting.max_features &&
         setting.threshold * kStep >= least_threshold) {
    setting.threshold *= kStep;
  }
  return setting;
}

// Bisects the logarithm of the threshold; the number of features decreases with it.
FeatureSetting SearchThreshold(DetectorKind kind, const cv::Mat& gray, int wanted) {
  constexpr int kMaxSteps = 24;
  const bool whole = kind == DetectorKind::kBrisk;
  Range range = ThresholdsOf(kind);
  FeatureSetting best{kind, range.low, 0};
  int best_miss = std::numeric_limits<int>::max();
  for (int step = 0; step < kMaxSteps && best_miss > kCountTolerance * wanted; ++step) {
    const double middle = std::sqrt(range.low * range.high);
    const FeatureSetting setting{kind, whole ? std::round(middle) : middle, 0};
    if (whole && (setting.threshold <= range.low || setting.threshold >= range.high)) {
      break;
    }
    const int count = Count(setting, gray);
    if (std::abs(count - wanted) < best_miss) {
      best = setting;
      best_miss = std::abs(count - wanted);
    }
    (count > wanted ? range.low : range.high) = setting.threshold;
  }
  return best;
}

}  // namespace

std::string ToString(const FeatureSetting& setting) {
  std::ostringstream text;
  text.precision(3);
  const bool orb = setting.kind == DetectorKind::kOrb;
  if (orb || setting.kind == DetectorKind::kSift) {
    text << "nfeatures = " << setting.max_features << ", ";
  }
  text << "threshold = " << (orb ? std::floor(setting.threshold) : setting.threshold);
  return text.str();
}

TunedFeature::TunedFeature(const FeatureSetting& setting) : detect_and_describe_(Create(setting)) {}

FeatureSetting SettingFor(DetectorKind kind, const cv::Mat& gray, int wanted) {
  assert(wanted > 0);
  switch (kind) {
    case DetectorKind::kOrb:
      return KeepStrongest({kind, kOrbThreshold, wanted}, gray, kMinOrbThreshold);
    case DetectorKind::kSift:
      return KeepStrongest({kind, kSiftThreshold, wanted}, gray, kMinSiftThreshold);
    default:
      return SearchThreshold(kind, gray, wanted);
  }
}

std::vector<cv::DMatch> MatchCrossChecked(const DescribedFeatures& first, const DescribedFeatures& second) {
  std::vector<cv::DMatch> matches;
  if (!first.descriptors.empty() && !second.descriptors.empty()) {
    const bool binary = first.descriptors.depth() == CV_8U;
    cv::BFMatcher(binary ? cv::NORM_HAMMING : cv::NORM_L2, true).match(first.descriptors, second.descriptors, matches);
  }
  return matches;
}

}  // namespace floorloc
