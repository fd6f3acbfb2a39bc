// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/features.h"

namespace floorloc {

const char* ToString(DescriptorType type) { return type == DescriptorType::kBinary ? "binary" : "float"; }

}  // namespace floorloc
