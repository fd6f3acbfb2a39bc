// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/features/descriptor_layout.h"

namespace floorloc {

/// Layout of an extractor's descriptors; also for extractors that this build does not have.
DescriptorLayout LayoutOf(ExtractorType type);

/// True for an extractor whose keypoints can be described at any heading (DescribeUpright).
bool HasUpright(ExtractorType type);

}  // namespace floorloc
