// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace floorloc {

/// Creates a benchmark's folder; one that is new or empty gets the benchmark's mark. What is in it stays.
void OpenStateFolder(const std::filesystem::path& folder, const std::string& benchmark);

/// The same, and removes what an earlier run of the benchmark left there. Throws InputError when the folder has content
/// but not this benchmark's mark: whoever names a folder of theirs must not lose it.
void ClearStateFolder(const std::filesystem::path& folder, const std::string& benchmark);

}  // namespace floorloc
