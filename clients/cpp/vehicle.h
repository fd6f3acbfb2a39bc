// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/client.h"

namespace floorloc::client {

/// A registered vehicle: its images, its odometry in batches, and when the server wants its next image. For one thread
/// at a time. Odometry that could not be sent is kept for the next call, and what arrived without the client hearing of
/// it counts once. When the server has forgotten the vehicle it is registered again.
class VehicleClient {
 public:
  /// Registers it: see Client::PutVehicle. batch_s: how long increments are collected, by their stamps. The client must
  /// outlive this.
  VehicleClient(Client& client, std::string id, nlohmann::json registration, double batch_s = 0.1);

  /// Adds the motion since the previous one; the answer when the batch was sent. Throws std::invalid_argument for what
  /// is not finite.
  std::optional<OdometryAnswer> Move(double stamp_s, const Motion& motion, CallTime deadline = {});
  /// Sends what was collected, if there is any.
  std::optional<OdometryAnswer> Flush(CallTime deadline = {});
  /// Sends what was collected and then an image, a JPEG or PNG. Give a deadline in a control loop: without it a server
  /// that is busy is asked again, with waits of seconds.
  FrameAnswer Frame(const std::string& image, double stamp_s, CallTime deadline = {});
  /// Whether the server wants an image by now, by `next` of its last answer and what was driven since.
  bool WantsFrame(double stamp_s) const { return stamp_s >= next_at_s_ || next_after_m_ <= 0.0; }

  const std::string& id() const { return id_; }
  std::size_t pending() const { return pending_.size(); }

 private:
  struct Pending {
    double stamp_s = 0.0;
    Motion motion;
  };

  template <typename Call>
  auto Registered(Call call);
  void NoteNext(const TrackingAnswer& answer, double stamp_s);

  Client& client_;
  std::string id_;
  nlohmann::json registration_;
  double batch_s_;
  std::vector<Pending> pending_;
  double next_at_s_ = -std::numeric_limits<double>::infinity();  ///< the server wants an image from this stamp on
  double next_after_m_ = 0.0;                                    ///< or when so much more was driven
};

}  // namespace floorloc::client
