// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "mapbuilder/survey/frame_journal.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

BuildFrame NamedFrame() {
  BuildFrame frame;
  frame.info.filename = "images/0.jpg";
  return frame;
}

// The key under which a frame's piece is kept: what is stored under it stands in the file.
std::string KeyOf(const std::filesystem::path& file, const std::vector<LoadedSurvey>& surveys) {
  constexpr std::size_t kKeyLength = 64;
  {
    BuildJournal journal(file, false, nullptr);
    FrameJournal(&journal, surveys, {}).Store(NamedFrame());
    journal.Flush();
  }
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t mark = std::string("floorloc journal 1\n").size() + 3 * sizeof(std::int64_t);
  return text.substr(mark, kKeyLength);
}

void CheckFrame(const BuildFrame& frame) {
  const cv::Mat& descriptors = frame.features.descriptors;
  if (static_cast<std::size_t>(descriptors.rows) != frame.features.keypoints.size() ||
      (!frame.brightness.empty() && frame.brightness.type() != CV_32FC1)) {
    std::abort();
  }
}

}  // namespace
}  // namespace floorloc

// The bytes as a frame's piece of a journal whose checksum is right: the frame that comes out of it is whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  static const std::vector<LoadedSurvey> surveys(1);
  const std::filesystem::path file = folder.path() / "m.floormap.journal";
  static const std::string key = KeyOf(file, surveys);
  {
    BuildJournal journal(file, false, nullptr);
    journal.Put(key, {data, data + size});
    journal.Flush();
  }
  BuildJournal journal(file, true, nullptr);
  BuildFrame frame = NamedFrame();
  if (FrameJournal(&journal, surveys, {}).Restore(&frame)) {
    CheckFrame(frame);
  }
  journal.Remove();
  return 0;
}
