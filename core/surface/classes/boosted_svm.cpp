// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/boosted_svm.h"

#include <algorithm>
#include <cmath>

namespace floorloc {

int SvmInput::size() const {
  int size = 0;
  for (const FeatureGroup group : groups) {
    size += GroupSize(group);
  }
  return size;
}

bool SvmInput::Has(const SegmentFeatures& segment) const {
  return std::none_of(groups.begin(), groups.end(), [&](FeatureGroup group) { return segment.Of(group).empty(); });
}

SampleMatrix SvmInput::Rows(std::span<const SegmentFeatures> segments) const {
  SampleMatrix rows = SampleMatrix::Zero(static_cast<Eigen::Index>(segments.size()), size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (!Has(segments[i])) {
      continue;
    }
    Eigen::Index column = 0;
    for (const FeatureGroup group : groups) {
      for (const float number : segments[i].Of(group)) {
        const auto place = static_cast<std::size_t>(column);
        rows(static_cast<Eigen::Index>(i), column++) = (number - mean[place]) * scale[place];
      }
    }
  }
  return rows;
}

Eigen::MatrixXf KernelSvm::Decide(const SampleMatrix& samples) const {
  const Eigen::VectorXf of_samples = samples.rowwise().squaredNorm();
  const Eigen::RowVectorXf of_vectors = vectors.rowwise().squaredNorm().transpose();
  Eigen::MatrixXf kernel = -2.0F * (samples * vectors.transpose());
  kernel.colwise() += of_samples;
  kernel.rowwise() += of_vectors;
  kernel = (kernel.array().max(0.0F) * -gamma).exp().matrix();
  return (kernel * weights).rowwise() + bias;
}

int DecisionBlock(float decision) {
  constexpr float kFirst = -1.5F;
  constexpr float kStep = 0.5F;
  int block = 0;
  for (float edge = kFirst; block < kDecisionBlocks - 1 && decision >= edge; edge += kStep) {
    ++block;
  }
  return block;
}

Eigen::MatrixXf BoostedSvm::Decide(std::span<const SegmentFeatures> segments) const {
  Eigen::MatrixXf sum = Eigen::MatrixXf::Zero(static_cast<Eigen::Index>(segments.size()), classes);
  std::vector<SampleMatrix> rows;
  for (const SvmInput& input : inputs) {
    rows.push_back(input.Rows(segments));
  }
  for (const WeakSvm& one : weak) {
    const auto input = static_cast<std::size_t>(one.input);
    const Eigen::MatrixXf decisions = one.svm.Decide(rows[input]);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (!inputs[input].Has(segments[i])) {
        continue;
      }
      const auto row = static_cast<Eigen::Index>(i);
      for (int c = 0; c < classes; ++c) {
        const float decision = decisions(row, c);
        sum(row, c) += one.confidences.size() == 0 ? decision : one.confidences(DecisionBlock(decision), c);
      }
    }
  }
  return sum;
}

}  // namespace floorloc
