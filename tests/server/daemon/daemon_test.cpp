// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/daemon.h"

#include <csignal>
#include <fstream>

#include "core/io/input_error.h"
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

// GoogleTest runs suites of such names first: the end of a child removes the maps that its parent had made.
TEST(DaemonDeathTest, StopsOnSignalsWithExitCodeZero) {
  EXPECT_EXIT(ServeWithPendingSignal(SIGTERM), testing::ExitedWithCode(0), "stopped");
  EXPECT_EXIT(ServeWithPendingSignal(SIGINT), testing::ExitedWithCode(0), "stopped");
}

// Two signals are pending: the lower number, SIGHUP, is taken first.
void ServeWithHangup(const std::filesystem::path& folder, const std::string& config) {
  sigset_t set;
  ::sigemptyset(&set);
  for (const int signal : {SIGHUP, SIGTERM}) {
    ::sigaddset(&set, signal);
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    ::kill(::getpid(), signal);
  }
  DaemonOptions options = Options(SharedMaps().folder());
  options.config_file = folder / "config.json";
  std::ofstream(options.config_file) << config;
  std::exit(RunDaemon(options));
}

TEST(DaemonDeathTest, HangupsReadTheTokenAgain) {
  const TemporaryFolder folder;
  const std::filesystem::path token = folder.path() / "token";
  std::ofstream(token) << "0123456789abcdef";
  std::filesystem::permissions(token, std::filesystem::perms::owner_read);
  EXPECT_EXIT(ServeWithHangup(folder.path(), R"({"token_file":"token"})"), testing::ExitedWithCode(0),
              "read again(.|\n)*stopped");
  EXPECT_EXIT(ServeWithHangup(folder.path(), "{}"), testing::ExitedWithCode(0), "no token file(.|\n)*stopped");
}

TEST(AppTest, ATokenIsReplacedUnlessTheNewOneIsBad) {
  const TemporaryFolder folder;
  ServerConfig config;
  config.token_file = folder.path() / "token";
  std::ofstream(config.token_file) << "0123456789abcdef";
  std::filesystem::permissions(config.token_file, std::filesystem::perms::owner_all);
  TestServer server(config);
  const auto status = [&](const std::string& token) {
    return ContractClient(server.port(), token).Delete("/v1/vehicles/a").status;
  };
  EXPECT_EQ(status("0123456789abcdef"), 404);
  std::ofstream(config.token_file) << "short";
  EXPECT_THROW(server.app().ReloadToken(), InputError);
  EXPECT_EQ(status("0123456789abcdef"), 404);
  std::ofstream(config.token_file) << "fedcba9876543210";
  server.app().ReloadToken();
  EXPECT_EQ(status("0123456789abcdef"), 401);
  EXPECT_EQ(status("fedcba9876543210"), 404);
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
