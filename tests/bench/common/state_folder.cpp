// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/state_folder.h"

#include <fstream>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

fs::path MarkOf(const fs::path& folder) { return folder / ".floorloc_benchmark"; }

std::string OwnerOf(const fs::path& folder) {
  std::ifstream file(MarkOf(folder));
  std::string owner;
  std::getline(file, owner);
  return owner;
}

}  // namespace

void OpenStateFolder(const fs::path& folder, const std::string& benchmark) {
  fs::create_directories(folder);
  if (fs::is_empty(folder) && !(std::ofstream(MarkOf(folder)) << benchmark << '\n')) {
    throw InputError(MarkOf(folder), "can't be written");
  }
}

void ClearStateFolder(const fs::path& folder, const std::string& benchmark) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw InputError(folder, "is not a folder; give --state a new or empty one");
  }
  if (fs::exists(folder) && !fs::is_empty(folder) && OwnerOf(folder) != benchmark) {
    throw InputError(folder, "is not empty and was not made by " + benchmark +
                                 ", which would delete what is in it; give --state a new or empty folder");
  }
  OpenStateFolder(folder, benchmark);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path() != MarkOf(folder)) {  // stays: a run that is killed meanwhile must not lock the next one out
      fs::remove_all(entry.path());
    }
  }
}

}  // namespace floorloc
