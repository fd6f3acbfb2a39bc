// SPDX-License-Identifier: Apache-2.0
#include "server/serving/last_frames.h"

#include <utility>

namespace floorloc {
namespace {

constexpr std::size_t kOtherBytes = 4096;  // of a frame beside image and mask, about

}  // namespace

KeptFrame::KeptFrame(const LocalizeJob& job, FixRecord fix)
    : image_(job.bytes.begin(), job.bytes.end()),
      fix_(std::move(fix)),
      job_(job),
      map_(job.map),
      rectifier_(job.camera.rectifier) {
  job_.map.reset();
  job_.camera.rectifier.reset();
  job_.bytes = {};
}

std::size_t KeptFrame::bytes() const {
  return image_.size() + job_.mask.left_out.total() * job_.mask.left_out.elemSize() + kOtherBytes;
}

LocalizeJob KeptFrame::Job() const {
  LocalizeJob job = job_;
  job.bytes = image_;
  job.camera.rectifier = rectifier_.lock();
  job.map = job.camera.rectifier == nullptr ? nullptr : map_.lock();
  return job;
}

void LastFrames::Put(const LocalizeJob& job, const FixRecord& fix) {
  if (max_bytes_ == 0) {
    return;
  }
  auto frame = std::make_shared<const KeptFrame>(job, fix);
  const std::lock_guard lock(mutex_);
  if (const auto known = by_vehicle_.find(fix.vehicle); known != by_vehicle_.end()) {
    EraseLocked(known->second);
  }
  bytes_ += frame->bytes();
  by_vehicle_[fix.vehicle] = entries_.insert(entries_.end(), std::move(frame));
  while (bytes_ > max_bytes_) {
    EraseLocked(entries_.begin());
  }
}

void LastFrames::EraseLocked(Entries::iterator entry) {
  bytes_ -= (*entry)->bytes();
  by_vehicle_.erase((*entry)->fix().vehicle);
  entries_.erase(entry);
}

std::shared_ptr<const KeptFrame> LastFrames::Find(const std::string& vehicle) const {
  const std::lock_guard lock(mutex_);
  const auto known = by_vehicle_.find(vehicle);
  return known == by_vehicle_.end() ? nullptr : *known->second;
}

void LastFrames::Remove(const std::string& vehicle) {
  const std::lock_guard lock(mutex_);
  if (const auto known = by_vehicle_.find(vehicle); known != by_vehicle_.end()) {
    EraseLocked(known->second);
  }
}

std::size_t LastFrames::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace floorloc
