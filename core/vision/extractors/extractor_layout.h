// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/features/descriptor_layout.h"

namespace floorloc {

/// Layout of an extractor's descriptors; also for extractors that this build does not have.
DescriptorLayout LayoutOf(ExtractorType type);

}  // namespace floorloc
