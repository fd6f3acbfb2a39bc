// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace floorloc {

/// Exit code of `build`: the map was written, but its verdict is not to use it.
inline constexpr int kBuiltButUnusable = 3;
/// Exit code of `check-drive`: something has to be mended.
inline constexpr int kRobotIsWrong = 3;

// Each adds one subcommand with its options and a callback that runs it. A callback returns on success and throws
// (InputError, MapError, std::invalid_argument, ...) on failure; main prints the message. CLI::RuntimeError sets the
// exit code and has no message.
void AddBuildCommand(CLI::App& app);
void AddCalibrateCommand(CLI::App& app);
void AddCheckDriveCommand(CLI::App& app);
void AddClassifyCommand(CLI::App& app);
void AddCompareCommand(CLI::App& app);
void AddDiffCommand(CLI::App& app);
void AddEvaluateCommand(CLI::App& app);
void AddEvaluateFeaturesCommand(CLI::App& app);
void AddExportCommand(CLI::App& app);
void AddImportCameraCommand(CLI::App& app);
void AddInfoCommand(CLI::App& app);
void AddLocalizeCommand(CLI::App& app);
void AddMergeCommand(CLI::App& app);
void AddOdometryCommand(CLI::App& app);
void AddReportCommand(CLI::App& app);
void AddSimulateCommand(CLI::App& app);
void AddTrainSurfaceCommand(CLI::App& app);
void AddVerifyCommand(CLI::App& app);

}  // namespace floorloc
