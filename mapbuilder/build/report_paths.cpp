// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/report_paths.h"

#include <string>

#include "core/io/survey.h"

namespace floorloc {
namespace {

// Replaces prefixes only: "./" is also the end of many other paths.
void ReplaceFolder(const std::filesystem::path& folder, const std::string& name, std::string* text) {
  const std::string from = (folder / "").string();
  for (std::size_t at = text->find(from); at != std::string::npos; at = text->find(from, at + 1)) {
    if (at == 0 || (*text)[at - 1] == ' ' || (*text)[at - 1] == '(') {
      text->replace(at, from.size(), name);
    }
  }
}

}  // namespace

BuildReport WithoutFolders(BuildReport report, const std::vector<std::filesystem::path>& surveys,
                           const std::filesystem::path& file) {
  const auto shorten = [&](std::string* text) {
    for (const std::filesystem::path& survey : surveys) {
      ReplaceFolder(survey, FolderName(survey) + "/", text);
    }
    if (file.has_parent_path()) {
      ReplaceFolder(file.parent_path(), "", text);
    }
  };
  for (std::string& warning : report.warnings) {
    shorten(&warning);
  }
  for (DroppedFrame& frame : report.dropped) {
    shorten(&frame.reason);
  }
  return report;
}

}  // namespace floorloc
