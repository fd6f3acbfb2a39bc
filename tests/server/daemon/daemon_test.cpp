// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.h"

#include <csignal>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

DaemonOptions Options(const std::filesystem::path& maps) {
  DaemonOptions options;
  options.maps_folder = maps;
  options.listen = "127.0.0.1:0";
  return options;
}

// Runs in a child process: a signal that is pending when the server starts stops it at once.
void ServeWithPendingSignal(int signal) {
  sigset_t set;
  ::sigemptyset(&set);
  ::sigaddset(&set, signal);
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
  ::kill(::getpid(), signal);
  std::exit(RunDaemon(Options(SharedMaps().folder())));
}

TEST(DaemonTest, StopsOnSignalsWithExitCodeZero) {
  EXPECT_EXIT(ServeWithPendingSignal(SIGTERM), testing::ExitedWithCode(0), "stopped");
  EXPECT_EXIT(ServeWithPendingSignal(SIGINT), testing::ExitedWithCode(0), "stopped");
}

TEST(DaemonTest, CheckSaysWhatWouldBeServed) {
  DaemonOptions options = Options(SharedMaps().folder());
  options.check = true;
  testing::internal::CaptureStdout();
  EXPECT_EQ(RunDaemon(options), 1);
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_THAT(text, testing::HasSubstr("hall: version "));
  EXPECT_THAT(text, testing::HasSubstr("broken: not served: "));

  const TemporaryFolder folder;
  std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", folder.path() / "hall.floormap");
  EXPECT_EQ(RunDaemon([&] {
              DaemonOptions good = options;
              good.maps_folder = folder.path();
              return good;
            }()),
            0);
}

TEST(DaemonTest, DoesNotStartWithoutAMapsFolder) {
  EXPECT_THROW(RunDaemon(Options("/nowhere/at/all")), std::runtime_error);
}

TEST(DaemonTest, DoesNotListenToTheWorldWithoutAToken) {
  DaemonOptions options = Options(SharedMaps().folder());
  options.listen = "0.0.0.0:0";
  EXPECT_THROW(RunDaemon(options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
