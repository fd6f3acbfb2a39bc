// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace floorloc {

/// What a frame shows beyond what all places have in common, sample by sample, cell by cell.
struct FrameRest {
  std::vector<float>
      gain;  ///< of the frame relative to the mosaic, in standard deviations of the rest; 0: not compared
  std::vector<float> value;  ///< standard deviations
};

/// How the mosaic under a sample changes with small displacements that are smooth over the view: shifts, turn, shear,
/// tilt. Errors of the pose, the camera's mounting and the map look like that; they do not tell places apart.
constexpr int kDistortions = 8;
using Distortion = Eigen::Matrix<float, kDistortions, 1>;

/// What a frame's places are scored by, sample by sample.
struct SampleScales {
  std::vector<float> mean;  ///< of the mosaic over the places, grey levels
  FrameRest rest;
  std::vector<float> deviation;         ///< typical one of the places, a standard deviation, grey levels
  std::vector<Distortion> distortions;  ///< not a number: not compared
};

struct PlaceScore {
  double score = 0.0;     ///< a standard normal value at a wrong place if the noise of samples is independent
  double expected = 0.0;  ///< its mean at the right one if the floor looks as in the mosaic
};

/// Scores places by a matched filter: what distinguishes a place from the mean one, but for distortions, in the rest of
/// the frame. Small differences are mostly noise of the mosaic, and what is true of floors is rare and strong: a
/// difference d counts as d^3 / (d^2 + D^2), as good as nothing well below the strong one D, and as itself well above.
class PlaceScorer {
 public:
  /// strong_deviations: D in typical deviations of the places at the sample, positive.
  PlaceScorer(SampleScales scales, double strong_deviations);

  /// mosaic: grey levels at the place, sample by sample; not a number: not surveyed. share_of_mean: what the place
  /// contributed to the mean, which is taken from it: each place is compared with the mean of the others.
  PlaceScore ScoreOf(const std::vector<float>& mosaic, double share_of_mean) const;

 private:
  struct Sample {
    float gain = 0.0F;  // FrameRest::gain; 0: not compared
    float value = 0.0F;
    float per_strong_square = 0.0F;  // 1 / D^2
  };
  using Vector = Eigen::Matrix<double, kDistortions, 1>;
  // Sums over samples: the normal equations of a fit of distortions.
  struct Normal {
    Eigen::Matrix<double, kDistortions, kDistortions> of_distortions =
        Eigen::Matrix<double, kDistortions, kDistortions>::Identity() * 1e-6;
    Vector with_rest = Vector::Zero();
  };

  void AddSample(std::size_t i, double sign, Normal* normal) const;

  std::vector<float> mean_;
  std::vector<Sample> samples_;
  std::vector<Distortion> distortions_;  // times the sample's gain
  Normal all_;
};

}  // namespace floorloc
