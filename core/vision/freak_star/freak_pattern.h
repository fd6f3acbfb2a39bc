// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core/types.hpp>

#include "core/vision/image/box_sampler.h"

namespace floorloc {

constexpr int kFreakRings = 7;
constexpr int kFreakRingFields = 6;
constexpr int kFreakFields = kFreakRings * kFreakRingFields + 1;

/// Mean grey levels of the receptive fields: from the outermost ring to the innermost, clockwise in each; the central
/// field last.
using FreakFields = std::array<float, kFreakFields>;

/// Pose of the retinal pattern in an image. Its rings shrink by a quarter from one to the next, each rotated by 30
/// degrees relative to the next outer one. A field is a square (upright in the image) whose side is its ring's radius:
/// it touches its neighbours on the ring and overlaps the next rings.
struct FreakPatternPose {
  cv::Point2f center;      ///< px
  float reach_px = 0.0F;   ///< from the centre to the outer side of the outermost fields
  float angle_deg = 0.0F;  ///< clockwise from the image's right
};

FreakFields SampleFreakFields(const FreakPatternPose& pose, BoxSampler* sampler);

/// The direction in which brightness rises, from 45 pairs of fields (every second and every opposite one on the five
/// outer rings), degrees clockwise from the image's right. The fields must have been sampled at the angle 0.
float FreakOrientation(const FreakFields& fields);

}  // namespace floorloc
