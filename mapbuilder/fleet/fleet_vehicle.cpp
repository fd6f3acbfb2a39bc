// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_vehicle.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <thread>

#include "mapbuilder/fleet/registration.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

enum SeedStream : std::uint64_t {
  kDrive = 1,
  kOdometry = 2,
  kConditions = 3,
  kClock = 4,
  kCalibration = 5,
  kPhase = 6
};

constexpr double kStepS = 0.02;             // of the drive and of the wheels
constexpr double kTickS = 0.05;             // at which a vehicle looks what is to be done
constexpr double kStandsAfterCarryS = 0.5;  // after it was put down
constexpr double kLampReachM = 2.0;         // farther lamps do not light what a camera sees

std::chrono::milliseconds Milliseconds(double seconds) {
  return std::chrono::milliseconds(std::llround(1000.0 * seconds));
}

std::string VehicleId(const FleetOptions& options, int number) {
  std::string digits = std::to_string(number + 1);
  const std::size_t width = std::to_string(options.schedule.vehicles).size();
  return options.prefix + std::string(width - digits.size(), '0') + digits;
}

std::string SecondsText(double seconds) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << seconds << " s";
  return text.str();
}

// The calibration that this vehicle was given.
FloorCamera Calibration(const FleetOptions& options, std::uint64_t seed) {
  cv::RNG rng(DeriveSeed(seed, kCalibration));
  CalibrationError error = options.calibration_error;
  for (double* part : {&error.radial_px, &error.tangential_px, &error.principal_point_px, &error.focal_share,
                       &error.roll_rad, &error.pitch_rad, &error.height_m}) {
    *part *= rng.uniform(-1.0, 1.0);
  }
  return Miscalibrated(options.camera, error);
}

client::ClientOptions CallOptions(const FleetOptions& options) {
  client::ClientOptions calls;
  calls.url = options.server;
  calls.token = options.token;
  calls.timeout = std::chrono::seconds(10);  // of the registration
  return calls;
}

// What a covered camera sees: next to nothing.
cv::Mat DarkImage(const CameraModel& camera, cv::RNG& rng) {
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC3);
  rng.fill(image, cv::RNG::NORMAL, 8.0, 3.0);
  return image;
}

std::string EncodeJpeg(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

client::Motion ToMotion(const Eigen::Vector3d& twist) {
  const Pose2 motion = Pose2::Exp(twist);
  return {motion.x(), motion.y(), motion.yaw()};
}

}  // namespace

FleetVehicle::FleetVehicle(FleetWorld* world, int number)
    : world_(world),
      number_(number),
      seed_(DeriveSeed(world->options.seed, static_cast<std::uint64_t>(number))),
      client_(std::make_unique<client::Client>(CallOptions(world->options))),
      drive_(world->area, world->options.drive, DeriveSeed(seed_, kDrive)),
      odometry_(world->options.odometry, world->options.imu, DeriveSeed(seed_, kOdometry)),
      conditions_(world->options.conditions, world->texture, world->options.camera, DeriveSeed(seed_, kConditions)),
      clock_noise_(DeriveSeed(seed_, kClock)) {
  summary_.id = VehicleId(world->options, number);
  client_->DeleteVehicle(summary_.id);  // of an earlier fleet
  server_ = std::make_unique<client::VehicleClient>(*client_, summary_.id,
                                                    FormatRegistration(world->map, Calibration(world->options, seed_)),
                                                    world->options.odometry_batch_s);
  truth_.Add(0.0, drive_.map_from_base());
  // Not all at once.
  next_image_s_ = cv::RNG(DeriveSeed(seed_, kPhase)).uniform(0.0, 1.0) / world->options.rate_hz;
}

void FleetVehicle::Unregister() {
  try {
    client_->DeleteVehicle(summary_.id);
  } catch (const client::CallError&) {  // the server is gone: nothing is left to be removed
  }
}

VehicleSummary FleetVehicle::summary() const { return summary_; }

void FleetVehicle::Run() {
  while (!world_->stop) {
    AdvanceTo(world_->clock.Now());
    if (ImageDue(now_s_)) {
      TakeImage();
    }
    const double wait_s = std::clamp(now_s_ + kTickS - world_->clock.Now(), 0.0, kTickS);
    std::this_thread::sleep_for(std::chrono::duration<double>(wait_s));
  }
}

void FleetVehicle::AdvanceTo(double time_s) {
  for (; now_s_ + kStepS <= time_s && !world_->stop; now_s_ += kStepS) {
    Step(now_s_ + kStepS);
  }
}

void FleetVehicle::Step(double time_s) {
  FollowSchedule(time_s);
  const Pose2 before = drive_.map_from_base();
  drive_.Advance(kStepS);
  TellOdometry(time_s, odometry_.Measure(before.Between(drive_.map_from_base()).Log(), kStepS));
  truth_.Add(time_s, drive_.map_from_base());
}

// Brakes, is lifted, is put down elsewhere; the camera of some is covered once the server has noticed it.
void FleetVehicle::FollowSchedule(double time_s) {
  const FleetSchedule& schedule = world_->schedule;
  const bool cover = schedule.IsCovered(number_, time_s);
  if (care_ == Care::kDrives && (cover || !schedule.Kidnaps(number_, now_s_, time_s).empty())) {
    care_ = Care::kBrakes;
    drive_.Halt();
  } else if (care_ == Care::kBrakes && drive_.stands()) {
    PutDown(time_s);
    care_ = cover ? Care::kAwaitsCover : Care::kDrives;
  } else if (care_ == Care::kAwaitsCover && summary_.status == "lost") {
    care_ = Care::kCovered;
    Say("has its camera covered and stays lost");
  } else if ((care_ == Care::kAwaitsCover || care_ == Care::kCovered) && !cover) {
    care_ = Care::kDrives;
    Say("sees the floor again");
  }
  if (care_ == Care::kDrives && time_s >= stands_until_s_) {
    drive_.Resume();
  }
  const bool silent = schedule.IsSilent(number_, time_s);
  if (silent != silent_) {
    silent_ = silent;
    Say(silent ? "falls silent" : "is heard again");
  }
  summary_.silent_s += silent ? kStepS : 0.0;
}

void FleetVehicle::PutDown(double time_s) {
  const Eigen::Vector2d old_place = drive_.map_from_base().translation();
  drive_.Carry();
  const double away_m = (drive_.map_from_base().translation() - old_place).norm();
  std::ostringstream text;
  text << "is kidnapped, " << std::fixed << std::setprecision(1) << away_m << " m from where it was lifted";
  Say(text.str());
  summary_.carried.push_back({time_s, std::nullopt, std::nullopt});
  stands_until_s_ = time_s + kStandsAfterCarryS;
}

template <typename Call>
void FleetVehicle::Try(Call call) {
  try {
    call();
    world_->last_answer_s = world_->clock.Now();
  } catch (const client::CallError& error) {
    ++summary_.failed[error.reason()];
    if (error.status() != 0) {
      world_->last_answer_s = world_->clock.Now();
    }
  }
}

void FleetVehicle::TellOdometry(double time_s, const Eigen::Vector3d& motion) {
  unsent_.push_back({world_->clock.UnixAt(time_s), ToMotion(motion)});
  if (silent_) {
    return;
  }
  for (const Unsent& one : unsent_) {
    Try([&] {
      if (const auto answer = server_->Move(one.stamp_s, one.motion, Milliseconds(world_->options.call_deadline_s))) {
        Note(*answer, time_s);
      }
    });
  }
  unsent_.clear();
}

// Whether it is time for an image, and the server wants one. Those that were missed are not made up for.
bool FleetVehicle::ImageDue(double time_s) {
  if (silent_ || time_s < next_image_s_) {
    return false;
  }
  if (!server_->WantsFrame(world_->clock.UnixAt(time_s))) {
    next_image_s_ = time_s;
    return false;
  }
  return true;
}

void FleetVehicle::TakeImage() {
  const double period_s = 1.0 / world_->options.rate_hz;
  std::string image;
  {
    const RenderSlots::Slot slot(&world_->slots);
    AdvanceTo(world_->clock.Now());
    image = RenderImage(now_s_);
  }
  const auto late = static_cast<long>(std::max(0.0, std::floor((now_s_ - next_image_s_) / period_s)));
  world_->images_late += late;
  world_->images_due += late + 1;
  next_image_s_ += period_s * static_cast<double>(late + 1);
  const double jitter_s = clock_noise_.gaussian(world_->options.clock_jitter_s);
  Try([&] {
    const client::FrameAnswer answer =
        server_->Frame(image, world_->clock.UnixAt(now_s_ + jitter_s), Milliseconds(world_->options.call_deadline_s));
    ++summary_.images;
    summary_.found += answer.fix.status == "localized" ? 1 : 0;
    Note(answer, now_s_);
    Judge(answer, now_s_);
  });
}

std::string FleetVehicle::RenderImage(double time_s) {
  const FleetOptions& options = world_->options;
  if (care_ == Care::kCovered) {
    return EncodeJpeg(DarkImage(options.camera.camera, clock_noise_), options.conditions.jpeg_quality);
  }
  const Pose2 corner_from_map(-world_->corner_m.x(), -world_->corner_m.y(), 0.0);
  const Pose2 pose = corner_from_map * drive_.map_from_base();
  RenderConditions conditions = conditions_.Sample(image_count_++, time_s, drive_.twist());
  std::erase_if(conditions.lamps, [&](const Lamp& lamp) {
    return !lamp.on_robot && (lamp.center_m - pose.translation()).norm() > kLampReachM;
  });
  return EncodeJpeg(world_->renderer.Render(pose, conditions), options.conditions.jpeg_quality);
}

// Says when the vehicle gets lost and when it is found.
void FleetVehicle::Note(const client::TrackingAnswer& answer, double time_s) {
  const bool first = summary_.status.empty() || summary_.errors_m.empty();
  if (answer.status == "lost" && summary_.status != "lost" && !first) {
    Say("is lost");
  }
  summary_.status = answer.status;
  if (!summary_.carried.empty() && !summary_.carried.back().noticed_s && answer.status != "localized") {
    summary_.carried.back().noticed_s = time_s - summary_.carried.back().time_s;
  }
}

// Compares the fused pose with the truth.
void FleetVehicle::Judge(const client::FrameAnswer& answer, double time_s) {
  if (answer.status != "localized" || !answer.pose) {
    return;
  }
  const std::optional<Pose2> truth = truth_.At(world_->clock.SinceStart(answer.pose->stamp));
  if (!truth) {
    return;
  }
  const Pose2 error = truth->Between(Pose2(answer.pose->x, answer.pose->y, answer.pose->yaw));
  const double error_m = error.translation().norm();
  const double error_rad = std::abs(error.yaw());
  const bool right = error_m <= world_->options.right_m && error_rad <= world_->options.right_rad;
  if (summary_.errors_m.empty() && ++world_->localized_once == world_->options.schedule.vehicles) {
    world_->Say(time_s, "", "all vehicles have been localized");
  }
  summary_.errors_m.push_back(error_m);
  summary_.errors_rad.push_back(error_rad);
  summary_.wrong += right ? 0 : 1;
  if (right && !summary_.carried.empty() && !summary_.carried.back().found_s) {
    Carried& carried = summary_.carried.back();
    carried.found_s = time_s - carried.time_s;
    Say("is found again after " + SecondsText(*carried.found_s));
  }
}

}  // namespace floorloc
