// SPDX-License-Identifier: Apache-2.0
#include "core/io/input_error.h"
#include "mapbuilder/cli/command.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/refusal.h"
#include "tests/synthetic/temporary_folder.h"

// The board and its places on the floor as people write them. There are no images of it: what passes ends at that.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  ByteSource source({data, size});
  const std::string images = folder.path().string();
  std::vector<std::string> arguments = {"calibrate", "--images=" + images, "--out=" + images,
                                        "--board=" + source.Text(), "--square=" + source.Text()};
  for (const char* option : {"--charuco=", "--marker=", "--roi=", "--board-pose=", "--model="}) {
    if (const std::string text = source.Text(); !text.empty()) {
      arguments.push_back(option + text);
    }
  }
  arguments.push_back("--floor-image=" + images + "/missing.jpg");
  CLI::App app("", "floorloc-mapbuilder");
  AddCalibrateCommand(app);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants a vector
  MayRefuse<CLI::Error, InputError, std::invalid_argument>([&] { app.parse(arguments); });
  return 0;
}
