// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/vision/extractors/upright_image.h"
#include "core/vision/features/features.h"
#include "core/vision/image/contrast.h"
#include "core/vision/image/ground_image.h"

namespace floorloc {

enum class ExtractorType { kHessian, kOrb, kSift, kAkaze, kBrisk, kSurf };

const char* ToString(ExtractorType type);
/// Throws std::invalid_argument that lists the known names.
ExtractorType ParseExtractorType(const std::string& name);
/// The types that this build has.
std::vector<ExtractorType> AllExtractorTypes();

/// All parameters that determine the features of an image. A map stores all of them; the server takes them from the
/// map.
struct ExtractorOptions {
  ExtractorType type = ExtractorType::kHessian;
  int max_keypoints = 700;  ///< strongest kept per image, spread evenly
  int cell_px = 48;         ///< side of the cells that keypoints are spread over
  int levels = 2;  ///< pyramid levels (octaves for AKAZE and SURF; SIFT has its own): few, as the scale is known
  double scale_factor = 1.4;     ///< between the levels of ORB's pyramid
  double threshold = 0.0;        ///< detector threshold on the contrast-normalised image; 0: default of the type
  int normalize_radius_px = 15;  ///< half side of the window of the local contrast normalisation; 0: none
  double smooth_sigma_px = 1.0;  ///< Gaussian smoothing before the normalisation; 0: none

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// How a mosaic is normalised that images, prepared with these options, are compared with.
ContrastOptions ContrastOfMosaic(const ExtractorOptions& options);

/// Detects and describes keypoints. Const and thread-safe.
class FeatureExtractor {
 public:
  virtual ~FeatureExtractor() = default;
  /// Keypoints in the base frame. Deterministic.
  Features Extract(const GroundImage& image) const {
    UprightImage unused;
    return Extract(image, Prepare(image), &unused);
  }
  /// The contrast-normalised image that keypoints are detected in, CV_8UC1, for callers that use it too.
  cv::Mat Prepare(const GroundImage& image) const;
  /// prepared: Prepare(image). upright: what describes the keypoints at any heading; left empty by extractors without
  /// upright descriptors.
  virtual Features Extract(const GroundImage& image, const cv::Mat& prepared, UprightImage* upright) const = 0;
  /// The image, prepared as Prepare() does, for upright descriptors of points of another extraction or of a mosaic.
  /// Empty: this extractor has none.
  virtual UprightImage MakeUpright(const GroundGrid& grid, const cv::Mat& prepared) const = 0;
  virtual DescriptorType descriptor_type() const = 0;
  virtual int descriptor_length() const = 0;  ///< bytes (binary) or numbers (float) per descriptor
  const ExtractorOptions& options() const { return options_; }

 protected:
  explicit FeatureExtractor(const ExtractorOptions& options) : options_(options) {}

 private:
  ExtractorOptions options_;
};

/// Throws std::invalid_argument when the options do not pass Check(), or for SURF in a build without it.
std::unique_ptr<FeatureExtractor> CreateFeatureExtractor(const ExtractorOptions& options);

}  // namespace floorloc
