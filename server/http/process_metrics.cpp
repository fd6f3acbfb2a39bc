// SPDX-License-Identifier: Apache-2.0
#include "server/http/process_metrics.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace floorloc {
namespace {

// Fields of /proc/self/stat, counted from that after the name, which may contain anything.
enum StatField { kUserTicks = 11, kSystemTicks = 12, kThreads = 17, kStartTicks = 19, kVirtualBytes = 20, kPages = 21 };

double CountOpenFiles() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  // Without the one that lists them.
  return error ? 0.0 : static_cast<double>(std::distance(begin(files), end(files)) - 1);
}

double Seconds(const timespec& time) {
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// start_s counts from the start of the machine.
double StartTime(double start_s) {
  timespec now{};
  timespec since_boot{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  ::clock_gettime(CLOCK_BOOTTIME, &since_boot);
  return Seconds(now) - Seconds(since_boot) + start_s;
}

}  // namespace

std::optional<ProcessMetrics> ReadProcessMetrics() {
  std::ifstream file("/proc/self/stat");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) {
    return std::nullopt;
  }
  std::istringstream stream(text.substr(name_end + 1));
  const std::vector<std::string> fields{std::istream_iterator<std::string>(stream), {}};
  if (fields.size() <= kPages) {
    return std::nullopt;
  }
  const auto ticks_per_s = static_cast<double>(::sysconf(_SC_CLK_TCK));
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  ProcessMetrics process;
  process.cpu_s = (std::stod(fields[kUserTicks]) + std::stod(fields[kSystemTicks])) / ticks_per_s;
  static const double kStart = StartTime(std::stod(fields[kStartTicks]) / ticks_per_s);
  process.start_s = kStart;  // once: clocks that are set move it
  process.resident_bytes = std::stod(fields[kPages]) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  process.virtual_bytes = std::stod(fields[kVirtualBytes]);
  process.threads = std::stod(fields[kThreads]);
  process.open_files = CountOpenFiles();
  process.max_open_files = static_cast<double>(files.rlim_cur);
  return process;
}

}  // namespace floorloc
