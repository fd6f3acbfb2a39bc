// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/localization/readout_fit.h"

namespace floorloc {

/// How a camera's read-out is learnt from the images of one vehicle.
struct ReadoutEstimatorOptions {
  int min_images = 8;         ///< before, nothing is said
  double max_sigma_s = 0.01;  ///< less certain ones are not used
  /// Nearer to 0 than so many standard deviations, and than so many seconds: a global shutter.
  double global_sigmas = 2.0;
  double global_s = 0.001;
  /// Images that are remembered; the oldest ones are dropped.
  std::size_t max_images = 40;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Median of the read-outs that single images show, which no image with a wrong motion or pose moves far.
class ReadoutEstimator {
 public:
  explicit ReadoutEstimator(const ReadoutEstimatorOptions& options = {});

  void Add(const ReadoutMeasurement& measurement);
  int images() const { return static_cast<int>(measurements_.size()); }
  /// Empty while there are too few images, or they disagree.
  std::optional<ReadoutMeasurement> Estimate() const;
  /// The newest measurements, the oldest first.
  const std::vector<ReadoutMeasurement>& Learnt() const { return measurements_; }
  /// Goes on with those of another estimator of this camera.
  void Resume(const std::vector<ReadoutMeasurement>& measurements);

 private:
  ReadoutEstimatorOptions options_;
  std::vector<ReadoutMeasurement> measurements_;
};

}  // namespace floorloc
