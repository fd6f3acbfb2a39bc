// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/pending_folder.h"

#include <system_error>

#include "core/io/input_error.h"

namespace floorloc {

namespace fs = std::filesystem;

PendingFolder::PendingFolder(const fs::path& target) : target_(target), pending_(target) {
  std::error_code error;
  if (fs::exists(target_) && !(fs::is_directory(target_) && fs::is_empty(target_, error) && !error)) {
    throw InputError(target_, "exists already and is not an empty folder; choose another name or remove it");
  }
  pending_ += ".partial";
  fs::remove_all(pending_, error);
  fs::create_directories(pending_, error);
  if (error) {
    throw InputError(pending_, "cannot be created (" + error.message() + "); check the path and its permissions");
  }
}

PendingFolder::~PendingFolder() {
  std::error_code ignored;
  fs::remove_all(pending_, ignored);
}

void PendingFolder::Complete() {
  std::error_code error;
  fs::rename(pending_, target_, error);  // replaces an empty folder
  if (error) {
    throw InputError(target_, "cannot be created (" + error.message() + "); check the path and its permissions");
  }
}

}  // namespace floorloc
