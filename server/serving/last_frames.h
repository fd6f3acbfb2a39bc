// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "server/serving/fix_history.h"
#include "server/serving/localize_service.h"

namespace floorloc {

/// The last image of a vehicle, and what else its localization depended on: localized again, it gives the same result.
class KeptFrame {
 public:
  /// Copies the image. fix: what became of it.
  KeptFrame(const LocalizeJob& job, FixRecord fix);

  const FixRecord& fix() const { return fix_; }
  std::size_t bytes() const;
  /// To localize it again; refers to this frame. Its map is null when the map or the camera is not in use any more.
  LocalizeJob Job() const;

 private:
  std::vector<std::uint8_t> image_;  // encoded, as it was received
  FixRecord fix_;
  LocalizeJob job_;  // without what would keep a replaced map or camera in memory
  std::weak_ptr<const LoadedMap> map_;
  std::weak_ptr<const Rectifier> rectifier_;
};

/// The last image of every vehicle, in memory only and within a budget: the oldest give way. Thread-safe.
class LastFrames {
 public:
  /// max_bytes: of all frames together; 0: none is kept.
  explicit LastFrames(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void Put(const LocalizeJob& job, const FixRecord& fix);
  /// Null: none is kept.
  std::shared_ptr<const KeptFrame> Find(const std::string& vehicle) const;
  void Remove(const std::string& vehicle);
  std::size_t bytes() const;

 private:
  using Entries = std::list<std::shared_ptr<const KeptFrame>>;

  void EraseLocked(Entries::iterator entry);

  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  Entries entries_;  // oldest first
  std::unordered_map<std::string, Entries::iterator> by_vehicle_;
  std::size_t bytes_ = 0;
};

}  // namespace floorloc
