// SPDX-License-Identifier: Apache-2.0
#include "server/store/folder_watch.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/geometry/option_check.h"

namespace floorloc {

void FolderWatchOptions::Check() const {
  RequireOption(settle.count() >= 0.0, "settle must not be negative");
  RequireOption(interval.count() > 0.0, "interval must be positive");
}

FolderWatch::FolderWatch(const std::filesystem::path& folder, const FolderWatchOptions& options,
                         std::function<void()> changed)
    : options_((options.Check(), options)),
      changed_(std::move(changed)),
      inotify_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)),
      stop_(::eventfd(0, EFD_CLOEXEC)) {
  if (!inotify_ || ::inotify_add_watch(inotify_.get(), folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE) < 0) {
    spdlog::warn("the maps folder can't be watched ({}): it is looked at every {:.0f} s", std::strerror(errno),
                 options_.interval.count());
  }
  thread_ = std::thread([this] { Run(); });
}

FolderWatch::~FolderWatch() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
  thread_.join();
}

bool FolderWatch::Wait(std::chrono::duration<double> timeout, bool* changed) const {
  std::array<pollfd, 2> waiting{pollfd{stop_.get(), POLLIN, 0}, pollfd{inotify_.get(), POLLIN, 0}};
  ::poll(waiting.data(), waiting.size(), static_cast<int>(1e3 * timeout.count()));
  *changed = waiting[1].revents != 0;
  std::array<char, 4096> events{};
  while (*changed && ::read(inotify_.get(), events.data(), events.size()) > 0) {
  }
  return waiting[0].revents == 0;
}

void FolderWatch::Run() {
  bool changed = false;
  while (Wait(options_.interval, &changed)) {
    while (changed) {
      if (!Wait(options_.settle, &changed)) {
        return;
      }
    }
    try {
      changed_();
    } catch (const std::exception& error) {
      spdlog::error("the maps folder could not be looked at: {}", error.what());
    }
  }
}

}  // namespace floorloc
