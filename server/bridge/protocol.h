// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace floorloc {

// What is said by VDA 5050, in the words of its texts; MessageFormat writes it as each version wants it.

enum class VdaVersion { kVersion2, kVersion3 };

struct VehicleIdentity {
  std::string manufacturer;
  std::string serial_number;
};

struct MessageHeader {
  std::uint32_t id = 0;  ///< of its topic, one more with each message
  double time_s = 0.0;   ///< Unix time
  VehicleIdentity identity;
};

/// agvPosition of 2.1, mobileRobotPosition of 3.0.
struct Position {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;  ///< -pi to pi
  std::string map_id;
  std::string map_description;  ///< of 2.1
  bool localized = false;
  double score = 0.0;                       ///< 0: unknown, 1: known
  std::optional<double> deviation_range_m;  ///< radius that holds the position with 95 %
};

/// Of the base frame, m/s and rad/s.
struct Velocity {
  double vx = 0.0;
  double vy = 0.0;
  double omega = 0.0;
};

struct MapEntry {
  std::string id;
  std::string version;
  bool enabled = false;

  bool operator==(const MapEntry&) const = default;
};

/// Both versions know these two.
enum class ErrorLevel { kWarning, kFatal };

struct ErrorReference {
  std::string key;
  std::string value;

  bool operator==(const ErrorReference&) const = default;
};

struct VehicleError {
  std::string type;
  ErrorLevel level = ErrorLevel::kWarning;
  std::string description;
  std::vector<ErrorReference> references;

  bool operator==(const VehicleError&) const = default;
};

// Predefined error types (3.0, 7.8); those of 2.1 are free.
inline constexpr const char* kLocalizationError = "LOCALIZATION_ERROR";
inline constexpr const char* kUnknownMapId = "UNKNOWN_MAP_ID";
inline constexpr const char* kDuplicateMap = "DUPLICATE_MAP";
inline constexpr const char* kInvalidInstantAction = "INVALID_INSTANT_ACTION";
inline constexpr const char* kInvalidOrder = "INVALID_ORDER";
inline constexpr const char* kValidationFailure = "VALIDATION_FAILURE";

enum class ActionStatus { kRunning, kFinished, kFailed };

struct ActionState {
  std::string id;
  std::string type;
  ActionStatus status = ActionStatus::kRunning;
  std::string result;  ///< a sentence; empty: none

  bool operator==(const ActionState&) const = default;
};

enum class ConnectionState { kOnline, kOffline, kBroken };

/// The state of a vehicle that has no client of its own, and no orders.
struct StateReport {
  std::optional<Position> position;
  std::optional<Velocity> velocity;
  bool driving = false;
  std::vector<MapEntry> maps;
  std::vector<ActionState> instant_actions;
  std::vector<VehicleError> errors;
  std::string operating_mode;
  double charge_percent = 0.0;
};

}  // namespace floorloc
