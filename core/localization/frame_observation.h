// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/geometry/floor_plane.h"
#include "core/photometry/photometric_aligner.h"
#include "core/vision/extractors/upright_image.h"
#include "core/vision/features/features.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

/// What a Localizer needs of a frame: computed once, localized as often as needed.
struct FrameObservation {
  Features features;            ///< base frame
  UprightImage upright;         ///< describes them at any heading
  FrameSamples samples;         ///< to be aligned to the mosaic
  RectM roi;                    ///< region of interest of the camera, base frame
  double offset_sigma_m = 0.0;  ///< FloorPlane::offset_sigma_m of the camera
  GroundImage floor;            ///< rectified, with what was left out
  double rectify_ms = 0.0;
  double features_ms = 0.0;
  cv::Mat left_out = {};                 ///< of `floor`, as in Localizer::Observe
  bool deblurred = false;                ///< the features are of an image whose blur was undone, `floor` is not
  std::optional<int> jpeg_quality = {};  ///< EstimateJpegQuality() of the image's file, by whoever has it

  void SetContext(const std::optional<CameraPrior>& camera_prior, std::optional<int> quality) {
    samples.SetCameraPrior(camera_prior);
    jpeg_quality = quality;
  }
};

}  // namespace floorloc
