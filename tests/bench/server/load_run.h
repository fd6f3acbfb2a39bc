// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/bench/server/load_plan.h"

namespace floorloc {

/// What became of a group's requests.
struct GroupOutcome {
  std::string name;
  /// Seconds by HTTP status, from when a request was due (closed loop: sent) to its whole answer. What waits for the
  /// client's own connection counts: a server that stalls does not hide the requests that it keeps from being sent.
  std::map<int, std::vector<double>> latencies_s;
  std::map<std::string, int> results;  ///< of the answers with status 200: how often each "status" was named
  int unanswered = 0;                  ///< due before the end, not answered within a second after it
  int broken = 0;                      ///< connections that were refused, reset or closed before an answer
};

/// Runs a plan with one thread and epoll.
std::vector<GroupOutcome> RunLoad(const LoadPlan& plan);

}  // namespace floorloc
