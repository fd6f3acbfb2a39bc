// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>

#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/refusal.h"
#include "tests/synthetic/temporary_folder.h"

namespace {

constexpr std::array kFiles = {"camera.yaml", "floor.yaml",         "frames.csv",          "odometry.tum",
                               "imu.csv",     "control_points.csv", "known_distances.csv", "groundtruth.tum"};

void WriteText(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

}  // namespace

// The files of a survey one after the other, zero bytes between them; one that would be empty is left out. The images
// 0.jpg and 1.jpg are there, and not opened.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  ByteSource source({data, size});
  for (const char* name : kFiles) {
    const std::string text = source.Text();
    std::filesystem::remove(folder.path() / name);
    if (!text.empty()) {
      WriteText(folder.path() / name, text);
    }
  }
  WriteText(folder.path() / "0.jpg", "");
  WriteText(folder.path() / "1.jpg", "");
  MayRefuse<InputError>([] { ReadSurvey(folder.path()); });
  MayRefuse<InputError>([] { ReadSurvey(folder.path(), BadFramePolicy::kSkip); });
  MayRefuse<InputError>([] { ReadCameraRecording(folder.path()); });
  return 0;
}
