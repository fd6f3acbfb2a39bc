// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "clients/cpp/vehicle.h"
#include "mapbuilder/fleet/fleet_summary.h"
#include "mapbuilder/fleet/fleet_world.h"
#include "mapbuilder/fleet/roaming_drive.h"
#include "mapbuilder/fleet/truth_record.h"
#include "mapbuilder/fleet/wheels_and_gyro.h"

namespace floorloc {

/// One vehicle of a fleet: drives, measures, takes images and tells the server. For one thread at a time.
class FleetVehicle {
 public:
  /// Registers it. number: from 0. The world must outlive it. Throws client::CallError.
  FleetVehicle(FleetWorld* world, int number);

  /// Drives in real time until the fleet stops.
  void Run();
  /// Removes it from the server; whether the server knows about it or not.
  void Unregister();
  VehicleSummary summary() const;

 private:
  enum class Care { kDrives, kBrakes, kAwaitsCover, kCovered };  // what people do with it

  void AdvanceTo(double time_s);
  void Step(double time_s);
  void FollowSchedule(double time_s);
  void PutDown(double time_s);
  void TellOdometry(double time_s, const Eigen::Vector3d& motion);
  bool ImageDue(double time_s);
  void TakeImage();
  std::string RenderImage(double time_s);
  void Note(const client::TrackingAnswer& answer, double time_s);
  void Judge(const client::FrameAnswer& answer, double time_s);
  void Say(const std::string& what) { world_->Say(now_s_, summary_.id, what); }
  template <typename Call>
  void Try(Call call);

  FleetWorld* world_;
  int number_;
  std::uint64_t seed_;
  VehicleSummary summary_;
  std::unique_ptr<client::Client> client_;
  std::unique_ptr<client::VehicleClient> server_;
  RoamingDrive drive_;
  WheelsAndGyro odometry_;
  ConditionSampler conditions_;
  TruthRecord truth_;
  cv::RNG clock_noise_;

  double now_s_ = 0.0;  // of the last step
  double next_image_s_ = 0.0;
  std::uint64_t image_count_ = 0;
  Care care_ = Care::kDrives;
  bool silent_ = false;
  double stands_until_s_ = 0.0;
  struct Unsent {
    double stamp_s;
    client::Motion motion;
  };
  std::vector<Unsent> unsent_;  // odometry of a silent vehicle
};

}  // namespace floorloc
