// SPDX-License-Identifier: Apache-2.0
// A robot's loop: odometry at every step, an image whenever the server wants one. Here both come from a recorded drive;
// put your wheels and camera in the places marked ROBOT.
//
//   floorloc_robot_loop SERVER MAP VEHICLE.json DRIVE_FOLDER
//
// VEHICLE.json: {"camera": ..., "floor": ...}; docs/server.md, "Register a vehicle", makes it.
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "clients/cpp/client.h"
#include "clients/cpp/vehicle.h"

namespace {

using floorloc::client::CallError;
using floorloc::client::Client;
using floorloc::client::FrameAnswer;
using floorloc::client::Motion;
using floorloc::client::VehicleClient;

constexpr std::chrono::milliseconds kDeadline{300};  // an older pose would be of no use to this robot

std::ifstream Open(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path + " can't be read");
  }
  return file;
}

std::string ReadFile(const std::string& path) {
  std::ifstream file = Open(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// ROBOT: the wheels. Reads odometry.tum, poses of the base, and says the motion from one to the next.
class Wheels {
 public:
  explicit Wheels(const std::string& folder) : file_(Open(folder + "/odometry.tum")) { Read(); }

  bool Step(double* stamp_s, Motion* motion) {
    const double x = x_;
    const double y = y_;
    const double yaw = yaw_;
    if (!Read()) {
      return false;
    }
    *stamp_s = stamp_s_;
    motion->dx = std::cos(yaw) * (x_ - x) + std::sin(yaw) * (y_ - y);
    motion->dy = -std::sin(yaw) * (x_ - x) + std::cos(yaw) * (y_ - y);
    motion->dyaw = std::remainder(yaw_ - yaw, 2.0 * M_PI);
    return true;
  }

 private:
  bool Read() {
    double z = 0.0;
    double qx = 0.0;
    double qy = 0.0;
    double qz = 0.0;
    double qw = 1.0;
    file_ >> stamp_s_ >> x_ >> y_ >> z >> qx >> qy >> qz >> qw;
    yaw_ = 2.0 * std::atan2(qz, qw);
    return !file_.fail();
  }

  std::ifstream file_;
  double stamp_s_ = 0.0;
  double x_ = 0.0;
  double y_ = 0.0;
  double yaw_ = 0.0;
};

// ROBOT: the camera. Reads frames.csv, the times and names of JPEG files.
class Camera {
 public:
  explicit Camera(const std::string& folder) : folder_(folder), file_(Open(folder + "/frames.csv")) {
    std::string header;
    std::getline(file_, header);
    Advance();
  }

  bool HasFrameUntil(double stamp_s) const { return !name_.empty() && stamp_s_ <= stamp_s; }
  double stamp_s() const { return stamp_s_; }
  std::string Jpeg() const { return ReadFile(folder_ + "/" + name_); }
  void Advance() {
    std::string line;
    std::getline(file_, line);
    const std::size_t comma = line.find(',');
    name_ = comma == std::string::npos ? "" : line.substr(comma + 1);
    stamp_s_ = name_.empty() ? 0.0 : std::stod(line.substr(0, comma));
  }

 private:
  std::string folder_;
  std::ifstream file_;
  std::string name_;
  double stamp_s_ = 0.0;
};

void Print(double stamp_s, const FrameAnswer& answer) {
  std::ostringstream line;
  line << std::fixed << stamp_s << ' ' << answer.status;
  if (const auto& pose = answer.pose) {
    line << ' ' << pose->x << ' ' << pose->y << ' ' << pose->yaw;
  }
  std::cout << line.str() << std::endl;
}

void SendStep(VehicleClient& vehicle, double stamp_s, const Motion& motion, Camera& camera) {
  vehicle.Move(stamp_s, motion, kDeadline);
  while (camera.HasFrameUntil(stamp_s)) {
    if (vehicle.WantsFrame(camera.stamp_s())) {
      Print(camera.stamp_s(), vehicle.Frame(camera.Jpeg(), camera.stamp_s(), kDeadline));
    }
    camera.Advance();
  }
}

void Drive(const std::string& server, nlohmann::json registration, const std::string& folder) {
  floorloc::client::ClientOptions options;
  options.url = server;
  Client client(options);
  VehicleClient vehicle(client, "cpp-example", std::move(registration));
  Wheels wheels(folder);
  Camera camera(folder);
  double stamp_s = 0.0;
  Motion motion;
  while (wheels.Step(&stamp_s, &motion)) {
    try {
      SendStep(vehicle, stamp_s, motion, camera);
    } catch (const CallError& error) {  // the robot goes on; its odometry is kept and sent with the next step
      std::cerr << std::fixed << stamp_s << ' ' << error.what() << '\n';
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "Usage: floorloc_robot_loop SERVER MAP VEHICLE.json DRIVE_FOLDER\n";
    return 2;
  }
  try {
    nlohmann::json registration = nlohmann::json::parse(ReadFile(argv[3]));
    registration["map"] = argv[2];
    Drive(argv[1], std::move(registration), argv[4]);
  } catch (const std::exception& error) {
    std::cerr << "floorloc_robot_loop: " << error.what() << '\n';
    return 1;
  }
}
