// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace floorloc {

/// Calls a function again and again, in a thread of its own. The function must not throw.
class Periodic {
 public:
  Periodic(std::chrono::duration<double> interval, std::function<void()> call);
  /// Waits for a call that runs.
  ~Periodic();
  Periodic(const Periodic&) = delete;
  Periodic& operator=(const Periodic&) = delete;

 private:
  void Run();

  const std::chrono::duration<double> interval_;
  const std::function<void()> call_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace floorloc
