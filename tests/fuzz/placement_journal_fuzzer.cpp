// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "mapbuilder/placement/placement_journal.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr std::size_t kFrames = 3;

void Require(bool ok) {
  if (!ok) {
    std::abort();
  }
}

bool IsFrame(int index) { return index >= 0 && static_cast<std::size_t>(index) < kFrames; }

void CheckPlacement(const std::optional<Placement>& placement) {
  if (!placement) {
    return;
  }
  Require(placement->map_from_base.size() == kFrames && placement->drop_reason.size() == kFrames);
  for (const Link& link : placement->links) {
    Require(IsFrame(link.first) && IsFrame(link.second));
  }
}

void CheckFixes(const std::optional<std::vector<PosePriorFactor>>& fixes) {
  for (const PosePriorFactor& fix : fixes.value_or(std::vector<PosePriorFactor>())) {
    Require(IsFrame(fix.frame));
  }
}

}  // namespace
}  // namespace floorloc

// The bytes as a piece of a journal whose checksum is right: what comes out of it fits the frames, or nothing does.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "m.floormap.journal";
  const std::string key(64, 'a');
  {
    BuildJournal journal(file, false, nullptr);
    journal.Put(key, {data, data + size});
    journal.Flush();
  }
  BuildJournal journal(file, true, nullptr);
  CheckPlacement(RestorePlacement(key, kFrames, &journal));
  CheckFixes(RestoreFixes(key, kFrames, &journal));
  journal.Remove();
  return 0;
}
