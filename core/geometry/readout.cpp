// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/readout.h"

#include <cmath>
#include <stdexcept>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// An exposure of a whole image takes no longer.
constexpr double kMaxReadoutS = 0.2;

Eigen::Matrix3d CovarianceOf(const Eigen::Vector3d& motion, double share) {
  const Eigen::Vector3d error = share * motion;
  return error * error.transpose();
}

}  // namespace

const char* ToString(ReadoutDirection direction) {
  switch (direction) {
    case ReadoutDirection::kDown:
      return "down";
    case ReadoutDirection::kUp:
      return "up";
    case ReadoutDirection::kRight:
      return "right";
    case ReadoutDirection::kLeft:
      return "left";
  }
  return "unknown";
}

const char* ToString(StampAt at) {
  switch (at) {
    case StampAt::kStart:
      return "start";
    case StampAt::kMiddle:
      return "middle";
    case StampAt::kEnd:
      return "end";
  }
  return "unknown";
}

ReadoutDirection ParseReadoutDirection(const std::string& name) {
  for (const ReadoutDirection direction :
       {ReadoutDirection::kDown, ReadoutDirection::kUp, ReadoutDirection::kRight, ReadoutDirection::kLeft}) {
    if (name == ToString(direction)) {
      return direction;
    }
  }
  throw std::invalid_argument("readout_direction must be down, up, right or left");
}

StampAt ParseStampAt(const std::string& name) {
  for (const StampAt at : {StampAt::kStart, StampAt::kMiddle, StampAt::kEnd}) {
    if (name == ToString(at)) {
      return at;
    }
  }
  throw std::invalid_argument("stamp_at must be start, middle or end");
}

void Readout::Check() const {
  if (seconds && !(*seconds >= 0.0 && *seconds <= kMaxReadoutS)) {
    throw std::invalid_argument(
        "readout_s must be the seconds from the first row to the last one, 0 (global shutter) to 0.2");
  }
  if (!seconds && stamp_at != StampAt::kMiddle) {
    throw std::invalid_argument("stamp_at start or end needs readout_s: the stamp is moved by half of it");
  }
}

std::int64_t Readout::StampShiftNs() const {
  if (stamp_at == StampAt::kMiddle) {
    return 0;
  }
  const std::int64_t half_ns = std::llround(0.5e9 * seconds.value_or(0.0));
  return stamp_at == StampAt::kStart ? half_ns : -half_ns;
}

void ReadoutOptions::Check() const {
  RequireOption(assumed_s >= 0.0 && assumed_s <= kMaxReadoutS, "assumed_s must be 0 to 0.2");
  RequireOption(assumed_mps >= 0.0, "assumed_mps must not be negative");
  RequireOption(assumed_radps >= 0.0, "assumed_radps must not be negative");
  RequireOption(error_share >= 0.0 && error_share <= 1.0, "error_share must be 0 to 1");
  RequireOption(residual_share >= 0.0 && residual_share <= 1.0, "residual_share must be 0 to 1");
}

ReadoutMotion MotionOfReadout(const Readout& readout, const std::optional<Eigen::Vector3d>& twist,
                              const ReadoutOptions& options) {
  ReadoutMotion result;
  if (readout.seconds && twist) {
    result.motion = *readout.seconds * *twist;
  } else if (readout.seconds) {
    const Eigen::Vector3d sigma = options.error_share * *readout.seconds *
                                  Eigen::Vector3d(options.assumed_mps, options.assumed_mps, options.assumed_radps);
    result.covariance = sigma.cwiseAbs2().asDiagonal();
  } else if (twist) {
    result.covariance = CovarianceOf(options.assumed_s * *twist, options.error_share);
  }
  return result;
}

}  // namespace floorloc
