// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/fusion/measurements.h"
#include "core/localization/localizer.h"
#include "tests/bench/ambiguity/recorded_drive.h"

namespace floorloc {

/// A way to find out where a vehicle is that was just switched on.
class StartMethod {
 public:
  virtual ~StartMethod() = default;

  virtual void Move(const MotionIncrement& motion) = 0;
  /// map_from_base once the method says that the vehicle is localized, at this frame.
  virtual std::optional<Pose2> See(const RecordedFrame& frame) = 0;
};

/// Names of the methods, in the order of the table.
std::vector<std::string> StartMethodNames();

/// A new one. seed: of its random draws. Throws std::invalid_argument for an unknown name.
std::unique_ptr<StartMethod> MakeStartMethod(const std::string& name, const Localizer& localizer, std::uint64_t seed);

}  // namespace floorloc
