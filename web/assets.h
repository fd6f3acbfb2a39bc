// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace floorloc {

/// A file of the web page, embedded at build time.
struct WebAsset {
  std::string_view name;  ///< path below web/; of other files, without folder
  const char* content_type = "";
  std::string_view hash;  ///< SHA-256 of the content, hex
  std::string_view content;
};

const std::vector<WebAsset>& AllWebAssets();
/// Null when there is no such file.
const WebAsset* FindWebAsset(std::string_view name);

}  // namespace floorloc
