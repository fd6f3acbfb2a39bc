// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/answers.h"
#include "clients/cpp/retry.h"

namespace floorloc::client {

struct ClientOptions {
  std::string url = "http://127.0.0.1:8080";
  std::string token;                          ///< empty: none is sent
  std::chrono::milliseconds timeout{10'000};  ///< of a call without a deadline
  RetryOptions retry;

  /// Throws std::invalid_argument that names the field.
  void Check() const;
};

/// A time as the calls take it: Unix seconds, with all digits of the nanoseconds.
std::string StampText(double stamp_s);
std::string StampText(std::chrono::nanoseconds since_1970);

/// Velocity of the robot, base frame, m/s and rad/s.
struct Twist {
  double vx = 0.0;
  double vy = 0.0;
  double wz = 0.0;
};

struct LocalizeRequest {
  std::string map;
  std::string vehicle;             ///< a registered one, whose camera took the image
  std::string image;               ///< a JPEG or PNG file
  std::optional<Transform> prior;  ///< where the robot probably is, in the map
  std::optional<double> radius_m;  ///< how far from the prior it may be
  std::optional<Twist> twist;      ///< for rolling shutters
  std::string stamp;               ///< empty: when it arrives
};

/// Motion in the base frame since the vehicle's previous message, m and rad.
struct Motion {
  double dx = 0.0;
  double dy = 0.0;
  double dyaw = 0.0;
};

struct FrameRequest {
  std::string image;  ///< a JPEG or PNG file
  std::string stamp;
  std::optional<Motion> odometry;
};

struct Increment {
  std::string stamp;
  Motion motion;
};

/// Of a map's mosaic: level, column to the right, row up.
struct Tile {
  int z = 0;
  int x = 0;
  int y = 0;
};

struct InitialPose {
  Transform map_from_base;
  std::optional<std::array<double, 9>> covariance;  ///< of (x, y, yaw), row by row; empty: of 0.1 m and 0.1 rad
  std::string stamp;                                ///< empty: that of the vehicle's newest message
};

/// How long the caller waits for an answer, attempts and waits between them included; empty: ClientOptions::timeout.
using CallTime = std::optional<std::chrono::milliseconds>;

/// The calls of a floorloc-server, named after the operations of schema/openapi.yaml. All throw CallError.
///
/// One keep-alive connection, opened by the first call, and again when the server has closed it. May be shared between
/// threads: their calls follow one another, so threads that should not wait for each other's images have a client each.
/// What is sent again (RetryOptions) has no effect twice: the server knows images and odometry by their stamps.
class Client {
 public:
  /// Throws std::invalid_argument.
  explicit Client(ClientOptions options = {});
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// registration: the body of PUT /v1/vehicles/{id}: map, camera, floor, and optionally mask, gate, correct_camera.
  void PutVehicle(const std::string& id, const nlohmann::json& registration);
  nlohmann::json GetVehicle(const std::string& id);
  /// False when there was none.
  bool DeleteVehicle(const std::string& id);

  /// A deadline is told to the server, which otherwise refuses at once what would take longer than its own (80 ms).
  LocalizeAnswer Localize(const LocalizeRequest& request, CallTime deadline = {});
  FrameAnswer PostFrame(const std::string& vehicle, const FrameRequest& request, CallTime deadline = {});
  /// Up to 1000 increments.
  OdometryAnswer PostOdometry(const std::string& vehicle, const std::vector<Increment>& increments,
                              CallTime deadline = {});
  TrackingAnswer PostInitialPose(const std::string& vehicle, const InitialPose& pose, CallTime deadline = {});

  nlohmann::json ListMaps();
  nlohmann::json ListVersions(const std::string& map);
  /// A map file as floorloc-mapbuilder writes it, read while it is sent; the Version that the server answers. Give it
  /// the time that its size takes. Throws std::invalid_argument when the file cannot be read.
  nlohmann::json UploadVersion(const std::string& map, const std::filesystem::path& file, CallTime deadline = {});
  nlohmann::json ActivateVersion(const std::string& map, const std::string& version, CallTime deadline = {});
  void DeleteVersion(const std::string& map, const std::string& version);
  /// With all its versions.
  void DeleteMap(const std::string& map);
  nlohmann::json GetMap(const std::string& map);
  /// A JPEG file of the map's mosaic; empty where it has no such tile. The answer of GetMap has the grid: `mosaic`.
  std::optional<std::string> GetTile(const std::string& map, const Tile& tile);
  nlohmann::json ListVehicles();
  /// Whether the server takes work; false when it does not answer.
  bool IsReady();

 private:
  class Connection;
  struct Request;

  nlohmann::json Call(const Request& request, CallTime time = {});
  std::string CallForBytes(const Request& request, CallTime time = {});
  std::string Attempt(const Request& request, const class Deadline& deadline);

  ClientOptions options_;
  std::unique_ptr<Connection> connection_;
};

}  // namespace floorloc::client
