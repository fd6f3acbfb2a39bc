// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/place_scorer.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

namespace floorloc {

PlaceScorer::PlaceScorer(SampleScales scales, double strong_deviations)
    : mean_(std::move(scales.mean)), distortions_(std::move(scales.distortions)) {
  const FrameRest& rest = scales.rest;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const bool compared = rest.gain[i] > 0.0F && scales.deviation[i] > 0.0F && !std::isnan(distortions_[i](0));
    const float strong = static_cast<float>(strong_deviations) * scales.deviation[i];
    samples_.push_back(compared ? Sample{rest.gain[i], rest.value[i], 1.0F / (strong * strong)} : Sample{});
    if (compared) {
      distortions_[i] *= rest.gain[i];
      AddSample(i, 1.0, &all_);
    }
  }
}

PlaceScore PlaceScorer::ScoreOf(const std::vector<float>& mosaic, double share_of_mean) const {
  const auto per_rest = static_cast<float>(1.0 / (1.0 - share_of_mean));
  const auto mean_moves = static_cast<float>(share_of_mean / (1.0 - share_of_mean));  // away from the place
  Normal normal = all_;
  Distortion with_difference = Distortion::Zero();
  Distortion with_move = Distortion::Zero();
  double squares = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const Sample& sample = samples_[i];
    if (sample.gain == 0.0F) {
      continue;
    }
    const float from_mean = mosaic[i] - mean_[i];
    if (std::isnan(from_mean)) {
      AddSample(i, -1.0, &normal);
      continue;
    }
    const float move = sample.gain * mean_moves * from_mean;
    const float apart = per_rest * from_mean;
    const float strength = apart * apart * sample.per_strong_square;
    const float difference = sample.gain * apart * strength / (1.0F + strength);
    with_difference += difference * distortions_[i];
    with_move += move * distortions_[i];
    squares += static_cast<double>(difference * difference);
    product += static_cast<double>(difference * (sample.value + move));
  }
  const Vector with = with_difference.cast<double>();
  const Vector fitted = normal.of_distortions.selfadjointView<Eigen::Lower>().ldlt().solve(with);
  squares -= fitted.dot(with);
  if (squares <= 0.0) {
    return {};
  }
  const double size = std::sqrt(squares);
  return {(product - fitted.dot(normal.with_rest + with_move.cast<double>())) / size, size};
}

void PlaceScorer::AddSample(std::size_t i, double sign, Normal* normal) const {
  const Vector distortion = distortions_[i].cast<double>();
  normal->of_distortions.selfadjointView<Eigen::Lower>().rankUpdate(distortion, sign);
  normal->with_rest += sign * static_cast<double>(samples_[i].value) * distortion;
}

}  // namespace floorloc
