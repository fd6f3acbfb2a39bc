// SPDX-License-Identifier: Apache-2.0
#include "web/assets.h"

#include <algorithm>

namespace floorloc {

const WebAsset* FindWebAsset(std::string_view name) {
  const std::vector<WebAsset>& assets = AllWebAssets();
  const auto found = std::find_if(assets.begin(), assets.end(), [name](const WebAsset& a) { return a.name == name; });
  return found == assets.end() ? nullptr : &*found;
}

}  // namespace floorloc
