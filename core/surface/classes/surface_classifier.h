// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "core/surface/classes/boosted_svm.h"
#include "core/surface/classes/segmentation.h"
#include "core/surface/classes/surface_image.h"

namespace floorloc {

/// Everything that classifying needs, as `train-surface` learns it.
struct SurfaceModel {
  std::vector<std::string> classes;
  int max_side_px = 640;  ///< larger images are reduced to it: texture has the size that it had in training
  SegmentationOptions segmentation;
  FeatureOptions features;
  BoostedSvm boosted;
  float segment_sharpness = 1.0F;  ///< probabilities are the softmax of the sums times this: of one segment,
  float image_sharpness = 1.0F;    ///< and of an image, whose sum is the mean over its pixels

  /// Throws std::invalid_argument that says what does not fit together.
  void Check() const;
};

struct SegmentClass {
  int label = 0;       ///< index of the class
  float score = 0.0F;  ///< its probability
  int pixels = 0;      ///< of the reduced image
  cv::Rect box;        ///< in pixels of the image as given
};

struct SurfaceResult {
  int label = 0;                     ///< index of the image's class
  float score = 0.0F;                ///< its probability
  std::vector<float> probabilities;  ///< of all classes
  std::vector<SegmentClass> segments;
  cv::Mat segment_of_pixel;  ///< CV_32SC1, of the reduced image: index into segments
  double segmentation_s = 0.0, features_s = 0.0, classification_s = 0.0;
};

/// Reduces an image, depth and intensity to a longer side of at most max_side_px.
SurfaceImage ReduceImage(const SurfaceImage& image, int max_side_px);

/// Softmax of sharpness * sums.
std::vector<float> Probabilities(const Eigen::RowVectorXf& sums, float sharpness);

/// Classes of all segments of an image, and of the image as a whole. Const and thread-safe. Throws
/// std::invalid_argument when the image does not pass SurfaceImage::Check().
class SurfaceClassifier {
 public:
  /// Throws std::invalid_argument when the model does not pass SurfaceModel::Check().
  explicit SurfaceClassifier(SurfaceModel model);

  SurfaceResult Classify(const SurfaceImage& image) const;
  const SurfaceModel& model() const { return model_; }

 private:
  SurfaceModel model_;
};

}  // namespace floorloc
