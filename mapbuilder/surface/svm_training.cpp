// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/svm_training.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <string_view>
#include <vector>

namespace floorloc {
namespace {

constexpr int kMaxIterations = 2000;
constexpr double kTolerance = 1e-3;

// A machine of one class: weights of its own support vectors.
struct BinarySvm {
  cv::Mat vectors;  // CV_32F
  std::vector<double> weights;
  double bias = 0.0;
};

BinarySvm TrainBinary(const cv::Mat& samples, const cv::Mat& sides, const SvmParameters& parameters) {
  const cv::Ptr<cv::ml::SVM> svm = cv::ml::SVM::create();
  svm->setType(cv::ml::SVM::C_SVC);
  svm->setKernel(cv::ml::SVM::RBF);
  svm->setC(parameters.c);
  svm->setGamma(parameters.gamma);
  // Both sides weigh the same, however many samples they have.
  const double share = static_cast<double>(cv::countNonZero(sides > 0)) / sides.rows;
  svm->setClassWeights((cv::Mat_<double>(2, 1) << 0.5 / (1.0 - share), 0.5 / share));
  svm->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, kMaxIterations, kTolerance});
  svm->train(samples, cv::ml::ROW_SAMPLE, sides);
  BinarySvm result;
  cv::Mat weights;
  cv::Mat indices;
  // OpenCV decides for the smaller label when the sum minus rho is positive.
  result.bias = svm->getDecisionFunction(0, weights, indices);
  const cv::Mat vectors = svm->getSupportVectors();
  for (int i = 0; i < static_cast<int>(indices.total()); ++i) {
    result.vectors.push_back(vectors.row(indices.at<int>(i)));
    result.weights.push_back(-weights.at<double>(i));
  }
  return result;
}

cv::Mat Sides(std::span<const int> classes, int positive) {
  cv::Mat sides(static_cast<int>(classes.size()), 1, CV_32SC1);
  for (int i = 0; i < sides.rows; ++i) {
    sides.at<int>(i) = classes[static_cast<std::size_t>(i)] == positive ? 1 : -1;
  }
  return sides;
}

using RowIndex = std::map<std::string_view, Eigen::Index>;

std::string_view BytesOf(const float* row, Eigen::Index size) {
  return {reinterpret_cast<const char*>(row), static_cast<std::size_t>(size) * sizeof(float)};
}

// Where samples stand, by their numbers: OpenCV copies support vectors and does not say which samples they were.
RowIndex IndexRows(const SampleMatrix& samples) {
  RowIndex index;
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    index.emplace(BytesOf(samples.row(i).data(), samples.cols()), i);
  }
  return index;
}

// Rows of samples that are support vectors of any class, with their weights in all of them.
void Join(const SampleMatrix& samples, const std::vector<Eigen::VectorXf>& weight_of_sample, KernelSvm* svm) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    if (std::any_of(weight_of_sample.begin(), weight_of_sample.end(), [i](const auto& w) { return w(i) != 0.0F; })) {
      used.push_back(i);
    }
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  svm->vectors.resize(count, samples.cols());
  svm->weights.resize(count, static_cast<Eigen::Index>(weight_of_sample.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    svm->vectors.row(i) = samples.row(used[static_cast<std::size_t>(i)]);
    for (std::size_t c = 0; c < weight_of_sample.size(); ++c) {
      svm->weights(i, static_cast<Eigen::Index>(c)) = weight_of_sample[c](used[static_cast<std::size_t>(i)]);
    }
  }
}

}  // namespace

KernelSvm TrainKernelSvm(const SampleMatrix& samples, std::span<const int> classes, int class_count,
                         const SvmParameters& parameters) {
  // OpenCV only reads the samples, but cv::Mat has no const header.
  const cv::Mat rows(static_cast<int>(samples.rows()), static_cast<int>(samples.cols()), CV_32FC1,
                     const_cast<float*>(samples.data()));
  const RowIndex index = IndexRows(samples);
  KernelSvm svm;
  svm.gamma = static_cast<float>(parameters.gamma);
  svm.bias.resize(class_count);
  std::vector<Eigen::VectorXf> weights(static_cast<std::size_t>(class_count), Eigen::VectorXf::Zero(samples.rows()));
  for (int c = 0; c < class_count; ++c) {
    const auto members = std::count(classes.begin(), classes.end(), c);
    if (members == 0 || members == static_cast<std::ptrdiff_t>(classes.size())) {
      svm.bias(c) = members == 0 ? -1.0F : 1.0F;
      continue;
    }
    const BinarySvm binary = TrainBinary(rows, Sides(classes, c), parameters);
    svm.bias(c) = static_cast<float>(binary.bias);
    for (std::size_t i = 0; i < binary.weights.size(); ++i) {
      const auto* vector = binary.vectors.ptr<float>(static_cast<int>(i));
      weights[static_cast<std::size_t>(c)](index.at(BytesOf(vector, samples.cols()))) +=
          static_cast<float>(binary.weights[i]);
    }
  }
  Join(samples, weights, &svm);
  return svm;
}

}  // namespace floorloc
