// SPDX-License-Identifier: Apache-2.0
#include "server/serving/rectifier_store.h"

#include <cmath>
#include <cstring>
#include <iterator>

#include "core/geometry/option_check.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

// cv::remap's fixed-point maps: coordinates (2 x 16 bit) and fractions (16 bit); and the mask (8 bit).
constexpr double kBytesPerPixel = 7.0;

void Append(double value, std::string& key) {
  const std::size_t at = key.size();
  key.resize(at + sizeof value);
  std::memcpy(key.data() + at, &value, sizeof value);
}

// The bit patterns of all parameters of the lookup tables, and of what the calibration is worth, which the Localizer
// asks the rectifier for; the camera's name has no influence on either.
std::string KeyOf(const FloorCamera& camera) {
  std::string key;
  const CameraModel& c = camera.camera;
  for (const double value : {static_cast<double>(c.width_px), static_cast<double>(c.height_px), c.fx, c.fy, c.cx, c.cy,
                             static_cast<double>(c.distortion_model)}) {
    Append(value, key);
  }
  for (const double value : c.distortion) {
    Append(value, key);
  }
  for (const double value : {c.readout.seconds.value_or(-1.0), static_cast<double>(c.readout.direction),
                             static_cast<double>(c.readout.stamp_at)}) {
    Append(value, key);
  }
  const FloorPlane& f = camera.floor;
  for (int i = 0; i < 9; ++i) {
    Append(f.base_from_pixel(i / 3, i % 3), key);
  }
  for (const double value :
       {f.roi.x_min, f.roi.x_max, f.roi.y_min, f.roi.y_max, f.resolution_m, f.offset_sigma_m, c.sigma_px}) {
    Append(value, key);
  }
  return key;
}

double RectifiedPixels(const FloorPlane& floor) {
  return std::ceil(floor.roi.width_m() / floor.resolution_m) * std::ceil(floor.roi.height_m() / floor.resolution_m);
}

void CheckCamera(const FloorCamera& camera, std::int64_t max_pixels) {
  try {
    camera.Check();
  } catch (const std::invalid_argument& error) {
    throw Problem(422, "invalid_camera", error.what());
  }
  const auto limit = static_cast<double>(max_pixels);
  if (static_cast<double>(camera.camera.width_px) * camera.camera.height_px > limit ||
      RectifiedPixels(camera.floor) > limit) {
    throw Problem(422, "camera_too_large",
                  "The camera's image, or its floor at this resolution, has more than " + std::to_string(max_pixels) +
                      " pixels.");
  }
}

std::size_t BytesOf(const FloorCamera& camera, const CameraMask& mask) {
  const double raw_pixels = static_cast<double>(camera.camera.width_px) * camera.camera.height_px;
  return static_cast<std::size_t>(kBytesPerPixel * RectifiedPixels(camera.floor) + (mask.empty() ? 0.0 : raw_pixels));
}

std::shared_ptr<const Rectifier> Build(const FloorCamera& camera, const CameraMask& mask) {
  auto rectifier = std::make_shared<const Rectifier>(camera, DecodeMask(mask, camera.camera));
  if (rectifier->masked_share() >= 1.0) {
    throw Problem(422, "mask_hides_floor",
                  "The mask leaves nothing of the camera's floor region; paint white what is floor.");
  }
  return rectifier;
}

}  // namespace

void RectifierStoreOptions::Check() const {
  RequireOption(max_image_pixels >= 1, "max_image_pixels must be at least 1");
  RequireOption(max_bytes >= 1, "max_bytes must be at least 1");
  RequireOption(max_cached >= 1, "max_cached must be at least 1");
}

RectifierStore::RectifierStore(const RectifierStoreOptions& options) : options_(options) { options_.Check(); }

void RectifierStore::Check(const FloorCamera& camera) const { CheckCamera(camera, options_.max_image_pixels); }

std::shared_ptr<const Rectifier> RectifierStore::Get(const FloorCamera& camera, const CameraMask& mask) {
  Check(camera);
  const std::string key = KeyOf(camera) + mask.digest;
  const std::size_t bytes = BytesOf(camera, mask);
  {
    const std::lock_guard lock(mutex_);
    if (auto rectifier = FindLocked(key)) {
      return rectifier;
    }
    EvictLocked(bytes);
    bytes_ += bytes;
  }
  std::shared_ptr<const Rectifier> rectifier;
  try {
    rectifier = Build(camera, mask);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    bytes_ -= bytes;
    throw;
  }
  const std::lock_guard lock(mutex_);
  if (auto built_by_another_thread = FindLocked(key)) {
    bytes_ -= bytes;
    return built_by_another_thread;
  }
  entries_.push_front({key, bytes, rectifier});
  by_key_[key] = entries_.begin();
  return rectifier;
}

std::shared_ptr<const Rectifier> RectifierStore::FindLocked(const std::string& key) {
  const auto it = by_key_.find(key);
  if (it == by_key_.end()) {
    return nullptr;
  }
  entries_.splice(entries_.begin(), entries_, it->second);
  return it->second->rectifier;
}

// Evicts the least recently used entries that no vehicle or request holds.
void RectifierStore::EvictLocked(std::size_t bytes) {
  std::size_t unused = 0;
  for (const Entry& entry : entries_) {
    unused += entry.rectifier.use_count() == 1 ? 1 : 0;
  }
  for (auto it = entries_.end(); it != entries_.begin();) {
    --it;
    if (bytes_ + bytes <= options_.max_bytes && unused < options_.max_cached) {
      break;
    }
    if (it->rectifier.use_count() == 1) {
      bytes_ -= it->bytes;
      --unused;
      by_key_.erase(it->key);
      it = entries_.erase(it);
    }
  }
  if (bytes_ + bytes > options_.max_bytes) {
    throw Overload("camera_memory_full",
                   "The cameras of all vehicles need more memory than the server may use for them.");
  }
}

}  // namespace floorloc
