// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "core/geometry/floor_plane.h"
#include "core/vision/image/rectifier.h"
#include "server/serving/camera_mask.h"

namespace floorloc {

struct RectifierStoreOptions {
  std::int64_t max_image_pixels = 25'000'000;    ///< of the camera image, and of the rectified one
  std::size_t max_bytes = std::size_t{1} << 30;  ///< lookup tables of all cameras together
  std::size_t max_cached = 64;                   ///< unused cameras that are kept

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// One Rectifier per calibration: vehicles with the same calibration share it, and a camera that is sent with every
/// request is built only once. Thread-safe.
class RectifierStore {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit RectifierStore(const RectifierStoreOptions& options);

  /// Throws Problem 422 for a camera that makes no sense or is too large.
  void Check(const FloorCamera& camera) const;

  /// The rectifier of a camera; builds it when it is new, which takes compute time.
  /// Throws Problem: 422 for a camera that makes no sense or is too large, or whose mask is none or leaves no floor
  /// (mask_hides_floor), 503 when the memory is full.
  std::shared_ptr<const Rectifier> Get(const FloorCamera& camera, const CameraMask& mask);

 private:
  struct Entry {
    std::string key;
    std::size_t bytes = 0;
    std::shared_ptr<const Rectifier> rectifier;
  };

  std::shared_ptr<const Rectifier> FindLocked(const std::string& key);
  void EvictLocked(std::size_t bytes);

  const RectifierStoreOptions options_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<std::string, std::list<Entry>::iterator> by_key_;
  std::size_t bytes_ = 0;
};

}  // namespace floorloc
