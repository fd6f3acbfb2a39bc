// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/bridge/protocol.h"
#include "server/bridge/server_reports.h"

namespace floorloc {

/// True once its input was true for a time, false once it was false for as long.
class Debounce {
 public:
  explicit Debounce(double after_s) : after_s_(after_s) {}

  void Set(bool input, double now_s) {
    if (input != input_ || !since_s_) {
      input_ = input;
      since_s_ = now_s;
    }
  }
  bool Output(double now_s) {
    if (since_s_ && now_s - *since_s_ >= after_s_) {
      output_ = input_;
    }
    return output_;
  }

 private:
  double after_s_;
  bool input_ = false;
  bool output_ = false;
  std::optional<double> since_s_;
};

/// Where a vehicle is, and whether that is known, of what the server says. Times are those of one steady clock,
/// seconds.
///
/// The position says at once that it is not localized; the error waits, so that a vehicle that is lost for one image,
/// or a server that restarts, stops no fleet.
class LocalizationMonitor {
 public:
  explicit LocalizationMonitor(double error_after_s) : error_(error_after_s) {}

  void OnPose(const PoseReport& report, double now_s);
  void OnStatus(const std::string& status, double now_s);
  void OnFix(const FixReport& fix);
  /// Whether the server answers, and whether it knows the vehicle.
  void OnServer(bool answers, double now_s);
  void OnKnown(bool known, double now_s);

  bool localized() const;
  /// Empty while not even the vehicle's map is known. Without any fix so far it is at the origin, not localized.
  std::optional<Position> position() const;
  const std::string& map() const { return map_; }
  /// LOCALIZATION_ERROR while the vehicle is not localized, debounced.
  std::optional<VehicleError> Error(double now_s);

 private:
  void Judge(double now_s) { error_.Set(!localized(), now_s); }

  Debounce error_;
  bool answers_ = false;
  bool known_ = false;
  std::string map_;
  std::string status_;
  std::optional<ReportedPose> pose_;
  double p_wrong_ = 1.0;  // of the last fix that the pose took
};

}  // namespace floorloc
