// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace floorloc {

/// Limits the bytes of all request bodies in memory at one time. Thread-safe.
class BodyBudget {
 public:
  explicit BodyBudget(std::size_t limit) : left_(static_cast<std::int64_t>(limit)) {}
  bool Acquire(std::size_t bytes) {
    if (left_.fetch_sub(static_cast<std::int64_t>(bytes)) >= static_cast<std::int64_t>(bytes)) {
      return true;
    }
    Release(bytes);
    return false;
  }
  void Release(std::size_t bytes) { left_.fetch_add(static_cast<std::int64_t>(bytes)); }

 private:
  std::atomic<std::int64_t> left_;
};

/// Reserves a part of the budget for the lifetime of one request.
class BodyReservation {
 public:
  BodyReservation(BodyBudget& budget, std::size_t bytes) : budget_(budget), bytes_(bytes), ok_(budget.Acquire(bytes)) {}
  ~BodyReservation() {
    if (ok_) {
      budget_.Release(bytes_);
    }
  }
  BodyReservation(const BodyReservation&) = delete;
  BodyReservation& operator=(const BodyReservation&) = delete;
  bool ok() const { return ok_; }

 private:
  BodyBudget& budget_;
  std::size_t bytes_;
  bool ok_;
};

}  // namespace floorloc
