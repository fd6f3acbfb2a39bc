// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/vehicle.h"

#include <cmath>
#include <stdexcept>

#include "clients/cpp/deadline.h"

namespace floorloc::client {
namespace {

constexpr std::size_t kMaxIncrements = 1000;  // of one body, by schema/openapi.yaml
constexpr double kStampStepS = 1e-6;          // doubles have Unix times to 0.2 us

// One motion of two: the second is in the base frame at the end of the first.
Motion Composed(const Motion& first, const Motion& second) {
  const double cosine = std::cos(first.dyaw);
  const double sine = std::sin(first.dyaw);
  return {first.dx + cosine * second.dx - sine * second.dy, first.dy + sine * second.dx + cosine * second.dy,
          first.dyaw + second.dyaw};
}

CallTime Left(CallTime time, const Deadline& deadline) {
  return time ? CallTime(std::chrono::ceil<std::chrono::milliseconds>(deadline.Left())) : time;
}

}  // namespace

VehicleClient::VehicleClient(Client& client, std::string id, nlohmann::json registration, double batch_s)
    : client_(client), id_(std::move(id)), registration_(std::move(registration)), batch_s_(batch_s) {
  client_.PutVehicle(id_, registration_);
}

template <typename Call>
auto VehicleClient::Registered(Call call) {
  try {
    return call();
  } catch (const CallError& error) {
    if (error.reason() != "unknown_vehicle") {
      throw;
    }
  }
  client_.PutVehicle(id_, registration_);
  return call();
}

std::optional<OdometryAnswer> VehicleClient::Move(double stamp_s, const Motion& motion, CallTime deadline) {
  for (const double number : {stamp_s, motion.dx, motion.dy, motion.dyaw}) {
    if (!std::isfinite(number)) {
      throw std::invalid_argument("odometry must be finite");
    }
  }
  pending_.push_back({stamp_s, motion});
  if (pending_.size() > kMaxIncrements) {  // the server was away for long
    pending_[1].motion = Composed(pending_[0].motion, pending_[1].motion);
    pending_.erase(pending_.begin());
  }
  next_after_m_ -= std::hypot(motion.dx, motion.dy);
  const bool full = std::abs(stamp_s - pending_.front().stamp_s) >= batch_s_ - kStampStepS;
  return full ? Flush(deadline) : std::nullopt;
}

std::optional<OdometryAnswer> VehicleClient::Flush(CallTime deadline) {
  if (pending_.empty()) {
    return std::nullopt;
  }
  std::vector<Increment> increments;
  for (const Pending& one : pending_) {
    increments.push_back({StampText(one.stamp_s), one.motion});
  }
  OdometryAnswer answer = Registered([&] { return client_.PostOdometry(id_, increments, deadline); });
  const double stamp_s = pending_.back().stamp_s;
  pending_.clear();
  NoteNext(answer, stamp_s);
  return answer;
}

FrameAnswer VehicleClient::Frame(const std::string& image, double stamp_s, CallTime deadline) {
  const Deadline end(deadline.value_or(std::chrono::milliseconds(0)));
  Flush(deadline);
  const FrameRequest request = {image, StampText(stamp_s), std::nullopt};
  FrameAnswer answer = Registered([&] { return client_.PostFrame(id_, request, Left(deadline, end)); });
  NoteNext(answer, stamp_s);
  return answer;
}

void VehicleClient::NoteNext(const TrackingAnswer& answer, double stamp_s) {
  next_at_s_ = stamp_s + answer.next.seconds;
  next_after_m_ = answer.next.metres;
}

}  // namespace floorloc::client
