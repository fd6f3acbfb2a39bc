// SPDX-License-Identifier: Apache-2.0
#include "server/serving/fair_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace floorloc {
namespace {

// While both classes wait, one job of this many is a search.
constexpr std::size_t kSearchEvery = 4;

}  // namespace

const char* ToString(WorkClass work) { return work == WorkClass::kTracking ? "tracking" : "search"; }

void FairQueue::Push(const std::string& client, WorkClass work, Job job) {
  Lane& lane = LaneOf(work);
  std::deque<Job>& jobs = lane.jobs[client];
  if (jobs.empty()) {
    lane.turns.push_back(client);
  }
  jobs.push_back(std::move(job));
  ++lane.size;
  ++size_;
}

WorkClass FairQueue::NextClass() {
  if (LaneOf(WorkClass::kSearch).size == 0) {
    return WorkClass::kTracking;
  }
  if (LaneOf(WorkClass::kTracking).size == 0) {
    return WorkClass::kSearch;
  }
  return ++turn_ % kSearchEvery == 0 ? WorkClass::kSearch : WorkClass::kTracking;
}

std::optional<FairQueue::Job> FairQueue::Pop() {
  if (size_ == 0) {
    return std::nullopt;
  }
  Lane& lane = LaneOf(NextClass());
  std::string client = std::move(lane.turns.front());
  lane.turns.pop_front();
  const auto jobs = lane.jobs.find(client);
  Job job = std::move(jobs->second.front());
  jobs->second.pop_front();
  if (jobs->second.empty()) {
    lane.jobs.erase(jobs);
  } else {
    lane.turns.push_back(std::move(client));
  }
  --lane.size;
  --size_;
  return job;
}

std::optional<FairQueue::Job> FairQueue::MakeRoomFor(const std::string& client, WorkClass work) {
  const auto own = LaneOf(work).jobs.find(client);
  const std::size_t count = (own == LaneOf(work).jobs.end() ? 0 : own->second.size()) + 1;
  Lane* longest_lane = nullptr;
  std::unordered_map<std::string, std::deque<Job>>::iterator longest;
  for (Lane& lane : lanes_) {
    for (auto jobs = lane.jobs.begin(); jobs != lane.jobs.end(); ++jobs) {
      if (longest_lane == nullptr || jobs->second.size() > longest->second.size()) {
        longest_lane = &lane;
        longest = jobs;
      }
    }
  }
  if (longest_lane == nullptr || longest->second.size() <= count) {
    return std::nullopt;
  }
  Job dropped = std::move(longest->second.back());
  longest->second.pop_back();  // more are left: it keeps its turn
  --longest_lane->size;
  --size_;
  return dropped;
}

std::vector<FairQueue::Job> FairQueue::Remove(const std::string& client) {
  std::vector<Job> removed;
  for (Lane& lane : lanes_) {
    const auto jobs = lane.jobs.find(client);
    if (jobs == lane.jobs.end()) {
      continue;
    }
    lane.size -= jobs->second.size();
    size_ -= jobs->second.size();
    std::move(jobs->second.begin(), jobs->second.end(), std::back_inserter(removed));
    lane.jobs.erase(jobs);
    lane.turns.erase(std::find(lane.turns.begin(), lane.turns.end(), client));
  }
  return removed;
}

FairQueue::Counts FairQueue::Ahead(const std::string& client, WorkClass work) const {
  const Lane& lane = LaneOf(work);
  const auto own = lane.jobs.find(client);
  const std::size_t rounds = own == lane.jobs.end() ? 0 : own->second.size();
  std::size_t ahead = rounds;
  for (const auto& [other, jobs] : lane.jobs) {
    ahead += other == client ? 0 : std::min(jobs.size(), rounds + 1);
  }
  const bool tracking = work == WorkClass::kTracking;
  const WorkClass other = tracking ? WorkClass::kSearch : WorkClass::kTracking;
  const std::size_t between =
      tracking ? (ahead + kSearchEvery - 1) / (kSearchEvery - 1) : (ahead + 1) * (kSearchEvery - 1);
  Counts counts{};
  counts[static_cast<std::size_t>(work)] = ahead;
  counts[static_cast<std::size_t>(other)] = std::min(LaneOf(other).size, between);
  return counts;
}

}  // namespace floorloc
