// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace floorloc {

/// Work of different urgency.
enum class WorkClass {
  kTracking,  ///< an image near a predicted pose
  kSearch,    ///< a search of the whole map, a vehicle's first image, the tables of a camera
  kCount,     ///< how many there are; stays last
};
/// "tracking", "search"
const char* ToString(WorkClass work);

/// What becomes of a waiting job.
enum class JobFate {
  kRun,
  kDropped,   ///< it waited too long, or made room for a job of a client that has fewer
  kReplaced,  ///< a newer one of its client took its place
};

/// Waiting jobs of many clients: one queue per client and class, served in turn (round robin), so that a client which
/// sends more than others delays its own jobs only. While both classes wait, one job of four is a search: a crowd of
/// lost vehicles cannot starve the others, nor the others them. Not thread-safe.
class FairQueue {
 public:
  /// Called once.
  using Job = std::function<void(JobFate)>;

  void Push(const std::string& client, WorkClass work, Job job);
  /// The next job; empty when none waits.
  std::optional<Job> Pop();
  /// Removes the newest job of the client with the most waiting ones, of a class; empty unless some client has more
  /// than `client` would have with one more: makes room for it.
  std::optional<Job> MakeRoomFor(const std::string& client, WorkClass work);

  /// Removes the waiting jobs of a client, of both classes.
  std::vector<Job> Remove(const std::string& client);

  std::size_t size() const { return size_; }

  /// How many jobs of each class run before one more of a client, at most, as long as no others come.
  using Counts = std::array<std::size_t, static_cast<std::size_t>(WorkClass::kCount)>;
  Counts Ahead(const std::string& client, WorkClass work) const;

 private:
  struct Lane {
    std::unordered_map<std::string, std::deque<Job>> jobs;  // by client; none is empty
    std::deque<std::string> turns;                          // clients, the next one first
    std::size_t size = 0;
  };

  Lane& LaneOf(WorkClass work) { return lanes_[static_cast<std::size_t>(work)]; }
  const Lane& LaneOf(WorkClass work) const { return lanes_[static_cast<std::size_t>(work)]; }
  WorkClass NextClass();

  std::array<Lane, static_cast<std::size_t>(WorkClass::kCount)> lanes_;
  std::size_t size_ = 0;
  std::size_t turn_ = 0;  // counts while both classes wait
};

}  // namespace floorloc
