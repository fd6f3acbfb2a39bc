// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/freak_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace floorloc {
namespace {

constexpr float kShrink = 0.75F;         // from a ring's radius to the next one's
constexpr float kReachPerRadius = 1.5F;  // the outermost ring's radius and half a field
constexpr int kOrientationRings = 5;

// Direction of a field from the centre, radians.
float FieldAngle(int ring, int field) {
  const float turned = ring % 2 == 0 ? 0.0F : 0.5F;
  return (static_cast<float>(field) + turned) * (2.0F * std::numbers::pi_v<float> / kFreakRingFields);
}

// Rings alternate between two patterns, scaled by their radius.
SamplePattern RingPattern(int ring) {
  SamplePattern pattern;
  for (int field = 0; field < kFreakRingFields; ++field) {
    pattern.u.push_back(std::cos(FieldAngle(ring, field)));
    pattern.v.push_back(std::sin(FieldAngle(ring, field)));
  }
  return pattern;
}

}  // namespace

FreakFields SampleFreakFields(const FreakPatternPose& pose, BoxSampler* sampler) {
  static const std::array<SamplePattern, 2> kRings{RingPattern(0), RingPattern(1)};
  static const SamplePattern kMiddle{{0.0F}, {0.0F}};
  const float angle = pose.angle_deg * std::numbers::pi_v<float> / 180.0F;
  const cv::Point2f direction(std::cos(angle), std::sin(angle));
  FreakFields fields;
  float radius = pose.reach_px / kReachPerRadius;
  int box = 1;
  for (int ring = 0; ring < kFreakRings; ++ring) {
    box = std::max(cvRound(radius), 1);
    sampler->Sample(kRings[static_cast<std::size_t>(ring % 2)], {pose.center, radius * direction, box},
                    fields.data() + ring * kFreakRingFields);
    radius *= kShrink;
  }
  sampler->Sample(kMiddle, {pose.center, direction, box}, fields.data() + kFreakFields - 1);
  return fields;
}

float FreakOrientation(const FreakFields& fields) {
  cv::Point2f sum;
  for (int ring = 0; ring < kOrientationRings; ++ring) {
    const float* const means = fields.data() + ring * kFreakRingFields;
    for (int a = 0; a < kFreakRingFields; ++a) {
      for (int b = a + 2; b <= std::min(a + kFreakRingFields - 2, kFreakRingFields - 1); ++b) {
        // The direction between two fields on a circle is perpendicular to the direction of their midpoint.
        const float towards = 0.5F * (FieldAngle(ring, a) + FieldAngle(ring, b)) - 0.5F * std::numbers::pi_v<float>;
        const float rise = means[a] - means[b];
        sum += rise * cv::Point2f(std::cos(towards), std::sin(towards));
      }
    }
  }
  return cv::fastAtan2(sum.y, sum.x);
}

}  // namespace floorloc
