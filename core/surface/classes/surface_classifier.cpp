// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/surface_classifier.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// Seconds since the last call.
class Lap {
 public:
  double operator()() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

int MostProbable(const std::vector<float>& probabilities) {
  return static_cast<int>(std::max_element(probabilities.begin(), probabilities.end()) - probabilities.begin());
}

// Boxes of the segments, enlarged to the original image.
void SetBoxes(const cv::Mat& labels, cv::Size original, std::vector<SegmentClass>* segments) {
  std::vector<cv::Rect> boxes(segments->size());
  for (int y = 0; y < labels.rows; ++y) {
    const int* row = labels.ptr<int>(y);
    for (int x = 0; x < labels.cols; ++x) {
      boxes[static_cast<std::size_t>(row[x])] |= cv::Rect(x, y, 1, 1);
    }
  }
  const double scale_x = static_cast<double>(original.width) / labels.cols;
  const double scale_y = static_cast<double>(original.height) / labels.rows;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const cv::Point begin(cvRound(boxes[i].x * scale_x), cvRound(boxes[i].y * scale_y));
    const cv::Point end(cvRound(boxes[i].br().x * scale_x), cvRound(boxes[i].br().y * scale_y));
    (*segments)[i].box = cv::Rect(begin, end);
  }
}

// Bounds within which no sum overflows; learnt numbers are far from them.
constexpr float kMaxNumber = 1e6F;
constexpr float kMaxMean = 1e12F;  // of a variance of intensities, say

template <typename Matrix>
bool IsWithin(const Matrix& matrix, float most) {
  return matrix.size() == 0 || (matrix.allFinite() && matrix.cwiseAbs().maxCoeff() <= most);
}

bool IsWithin(const std::vector<float>& numbers, float most) {
  return std::all_of(numbers.begin(), numbers.end(), [most](float number) { return std::abs(number) <= most; });
}

void CheckWeak(const WeakSvm& weak, const BoostedSvm& boosted) {
  RequireOption(weak.input >= 0 && static_cast<std::size_t>(weak.input) < boosted.inputs.size(),
                "a classifier's input must be one of the model's");
  const SvmInput& input = boosted.inputs[static_cast<std::size_t>(weak.input)];
  const KernelSvm& svm = weak.svm;
  RequireOption(svm.vectors.cols() == input.size() && svm.weights.rows() == svm.vectors.rows() &&
                    svm.weights.cols() == boosted.classes && svm.bias.size() == boosted.classes,
                "a classifier must have the sizes of its input and of the classes");
  RequireOption(weak.confidences.size() == 0 ||
                    (weak.confidences.rows() == kDecisionBlocks && weak.confidences.cols() == boosted.classes),
                "confidences must be given for all blocks and classes");
  RequireOption(svm.gamma > 0.0F && svm.gamma <= kMaxNumber && IsWithin(svm.vectors, kMaxNumber) &&
                    IsWithin(svm.weights, kMaxNumber) && IsWithin(svm.bias, kMaxNumber) &&
                    IsWithin(weak.confidences, kMaxNumber),
                "a classifier's numbers must be finite, up to 1e6");
}

}  // namespace

void SurfaceModel::Check() const {
  RequireOption(classes.size() >= 2, "classes must be two or more");
  RequireOption(max_side_px >= 16 && max_side_px <= 16384, "max_side_px must be 16 to 16384");
  segmentation.Check();
  features.Check();
  RequireOption(boosted.classes == static_cast<int>(classes.size()), "boosted must know the model's classes");
  for (const SvmInput& input : boosted.inputs) {
    const auto size = static_cast<std::size_t>(input.size());
    RequireOption(size > 0 && input.mean.size() == size && input.scale.size() == size,
                  "an input's mean and scale must have its size");
    RequireOption(IsWithin(input.mean, kMaxMean) && IsWithin(input.scale, kMaxNumber),
                  "an input's mean and scale must be finite, up to 1e12 and 1e6");
  }
  for (const WeakSvm& weak : boosted.weak) {
    CheckWeak(weak, boosted);
  }
  RequireOption(segment_sharpness > 0.0F && segment_sharpness < 1e6F, "segment_sharpness must be above 0");
  RequireOption(image_sharpness > 0.0F && image_sharpness < 1e6F, "image_sharpness must be above 0");
}

SurfaceImage ReduceImage(const SurfaceImage& image, int max_side_px) {
  const int side = std::max(image.color.cols, image.color.rows);
  if (side <= max_side_px) {
    return image;
  }
  const double scale = static_cast<double>(max_side_px) / side;
  const cv::Size size(std::max(cvRound(image.color.cols * scale), 1), std::max(cvRound(image.color.rows * scale), 1));
  SurfaceImage reduced;
  cv::resize(image.color, reduced.color, size, 0.0, 0.0, cv::INTER_AREA);
  if (image.has_range()) {
    cv::resize(image.depth_mm, reduced.depth_mm, size, 0.0, 0.0, cv::INTER_NEAREST);  // a hole has no neighbours
    cv::resize(image.intensity, reduced.intensity, size, 0.0, 0.0, cv::INTER_NEAREST);
  }
  return reduced;
}

std::vector<float> Probabilities(const Eigen::RowVectorXf& sums, float sharpness) {
  const Eigen::RowVectorXf powers = (sharpness * (sums.array() - sums.maxCoeff())).exp();
  const Eigen::RowVectorXf shares = powers / powers.sum();
  return {shares.data(), shares.data() + shares.size()};
}

SurfaceClassifier::SurfaceClassifier(SurfaceModel model) : model_(std::move(model)) { model_.Check(); }

SurfaceResult SurfaceClassifier::Classify(const SurfaceImage& image) const {
  image.Check();
  Lap lap;
  const SurfaceImage reduced = ReduceImage(image, model_.max_side_px);
  const Segmentation segmentation = SegmentImage(reduced.color, model_.segmentation);
  SurfaceResult result;
  result.segmentation_s = lap();
  const std::vector<SegmentFeatures> features = ExtractFeatures(reduced, segmentation, model_.features);
  result.features_s = lap();
  const Eigen::MatrixXf sums = model_.boosted.Decide(features);
  Eigen::RowVectorXf image_sum = Eigen::RowVectorXf::Zero(sums.cols());
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::RowVectorXf sum = sums.row(static_cast<Eigen::Index>(i));
    const std::vector<float> probabilities = Probabilities(sum, model_.segment_sharpness);
    const int label = MostProbable(probabilities);
    result.segments.push_back({label, probabilities[static_cast<std::size_t>(label)], features[i].pixels, {}});
    image_sum += sum * (static_cast<float>(features[i].pixels) / static_cast<float>(reduced.color.total()));
  }
  result.probabilities = Probabilities(image_sum, model_.image_sharpness);
  result.label = MostProbable(result.probabilities);
  result.score = result.probabilities[static_cast<std::size_t>(result.label)];
  SetBoxes(segmentation.labels, image.color.size(), &result.segments);
  result.segment_of_pixel = segmentation.labels;
  result.classification_s = lap();
  return result;
}

}  // namespace floorloc
