// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <mutex>

namespace floorloc {

/// Limits how many threads render at once; who waits longest is next.
class RenderSlots {
 public:
  explicit RenderSlots(int count) : free_(count) {}

  /// A place, kept until its end.
  class Slot {
   public:
    explicit Slot(RenderSlots* slots) : slots_(slots) { slots_->Enter(); }
    ~Slot() { slots_->Leave(); }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

   private:
    RenderSlots* slots_;
  };

 private:
  void Enter() {
    std::unique_lock lock(mutex_);
    const long ticket = last_ticket_++;
    changed_.wait(lock, [&] { return free_ > 0 && ticket == next_ticket_; });
    --free_;
    ++next_ticket_;
    changed_.notify_all();
  }
  void Leave() {
    const std::lock_guard lock(mutex_);
    ++free_;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int free_;
  long last_ticket_ = 0;
  long next_ticket_ = 0;
};

}  // namespace floorloc
