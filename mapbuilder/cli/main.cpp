// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "mapbuilder/cli/command.h"

// Exit codes: 0 success, 1 failure (one sentence on stderr), 2 usage error, 3 (kBuiltButUnusable,
// kRobotIsWrong) by `build` and `check-drive`.
int main(int argc, char** argv) {
  CLI::App app("Builds and inspects maps of floors, and localizes recorded frames in them.", "floorloc-mapbuilder");
  app.require_subcommand(1);
  app.set_version_flag("--version", FLOORLOC_VERSION);
  floorloc::AddBuildCommand(app);
  floorloc::AddCalibrateCommand(app);
  floorloc::AddImportCameraCommand(app);
  floorloc::AddLocalizeCommand(app);
  floorloc::AddCheckDriveCommand(app);
  floorloc::AddOdometryCommand(app);
  floorloc::AddInfoCommand(app);
  floorloc::AddVerifyCommand(app);
  floorloc::AddDiffCommand(app);
  floorloc::AddMergeCommand(app);
  floorloc::AddExportCommand(app);
  floorloc::AddEvaluateCommand(app);
  floorloc::AddEvaluateFeaturesCommand(app);
  floorloc::AddCompareCommand(app);
  floorloc::AddTrainSurfaceCommand(app);
  floorloc::AddClassifyCommand(app);
  floorloc::AddReportCommand(app);
  floorloc::AddSimulateCommand(app);
  cv::setNumThreads(1);  // --threads is the total; OpenCV's own pool would add to it
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "floorloc-mapbuilder: " << error.what() << "\n";
    return 1;
  }
}
