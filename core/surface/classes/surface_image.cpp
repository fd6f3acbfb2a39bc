// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/surface_image.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void SurfaceImage::Check() const {
  RequireOption(!color.empty() && color.type() == CV_8UC3, "color must have 3 channels of 8 bits");
  RequireOption(depth_mm.empty() == intensity.empty(), "depth_mm and intensity must be given together");
  if (has_range()) {
    RequireOption(depth_mm.type() == CV_16UC1 && intensity.type() == CV_16UC1,
                  "depth_mm and intensity must have 1 channel of 16 bits");
    RequireOption(depth_mm.size() == color.size() && intensity.size() == color.size(),
                  "depth_mm and intensity must be as large as color");
  }
}

}  // namespace floorloc
