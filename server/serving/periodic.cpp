// SPDX-License-Identifier: Apache-2.0
#include "server/serving/periodic.h"

#include <utility>

namespace floorloc {

Periodic::Periodic(std::chrono::duration<double> interval, std::function<void()> call)
    : interval_(interval), call_(std::move(call)), thread_([this] { Run(); }) {}

Periodic::~Periodic() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Periodic::Run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval_, [this] { return stopping_; })) {
    lock.unlock();
    call_();
    lock.lock();
  }
}

}  // namespace floorloc
