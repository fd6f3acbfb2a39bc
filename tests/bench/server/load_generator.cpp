// SPDX-License-Identifier: Apache-2.0
// Reads a load plan (load_plan.h) from standard input, runs it against a server on this machine, and prints what became
// of the requests as JSON.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/bench/server/load_plan.h"
#include "tests/bench/server/load_run.h"

namespace floorloc {
namespace {

void RaiseFileLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
}

// sorted: not empty.
double Quantile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

nlohmann::json ToJson(const GroupOutcome& outcome) {
  nlohmann::json statuses = nlohmann::json::object();
  for (const auto& [status, latencies] : outcome.latencies_s) {
    std::vector<double> sorted = latencies;
    std::sort(sorted.begin(), sorted.end());
    statuses[std::to_string(status)] = {{"count", sorted.size()},
                                        {"p50_ms", 1e3 * Quantile(sorted, 0.5)},
                                        {"p99_ms", 1e3 * Quantile(sorted, 0.99)},
                                        {"max_ms", 1e3 * sorted.back()}};
  }
  return {{"name", outcome.name},
          {"statuses", statuses},
          {"results", outcome.results},
          {"unanswered", outcome.unanswered},
          {"broken", outcome.broken}};
}

int Run() {
  RaiseFileLimit();
  LoadPlan plan;
  ReadLoadPlan({std::istreambuf_iterator<char>(std::cin), {}}, &plan);
  nlohmann::json groups = nlohmann::json::array();
  for (const GroupOutcome& outcome : RunLoad(plan)) {
    groups.push_back(ToJson(outcome));
  }
  std::cout << nlohmann::json({{"seconds", plan.seconds}, {"groups", groups}}) << "\n";
  return 0;
}

}  // namespace
}  // namespace floorloc

int main() {
  try {
    return floorloc::Run();
  } catch (const std::exception& error) {
    std::cerr << "load_generator: " << error.what() << "\n";
    return 1;
  }
}
