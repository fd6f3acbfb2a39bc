// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// What travels with a camera and stands still in its images.
enum class OverlayKind {
  kPart,  ///< a part of the robot with a sharp texture, in the lower left corner: wheel, bumper, mount
  kText,  ///< the camera's own time stamp and captions, along the upper border; its digits change
  kLogo,  ///< a sticker, in the upper right corner
  kDirt,  ///< spots on the glass
  kLamp,  ///< the pattern of a lamp on the camera: soft, it lights the floor and hides nothing
};
/// "part", "text", "logo", "dirt", "lamp"
std::vector<std::string> OverlayKindNames();
const char* ToString(OverlayKind kind);
/// Throws std::invalid_argument for another name.
OverlayKind ParseOverlayKind(const std::string& name);

struct OverlayOptions {
  OverlayKind kind = OverlayKind::kPart;
  double share = 0.0;      ///< of the image; 0: nothing is in view
  double sway_px = 0.0;    ///< standard deviation of its place, as a cable's; right and down
  std::uint64_t seed = 1;  ///< of its look and of the places of spots; the same in all recordings of one camera

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Overlay of images of one size. Immutable after construction, thread-safe.
class CameraOverlay {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  CameraOverlay(const OverlayOptions& options, cv::Size size_px);

  /// Covers what the camera sees, before the exposure: parts, stickers and dirt are lit, defocused and noisy as the
  /// floor but not blurred by motion. shift_px: right and down. image: CV_32FC1 or CV_32FC3, grey values.
  void CoverScene(const Eigen::Vector2d& shift_px, cv::Mat* image) const;
  /// Writes the text into the exposed image. time_s: since the recording's start.
  void BurnIn(double time_s, cv::Mat* image) const;
  /// Where something else than floor is seen or the lamp shines (CV_8UC1, 255 or 0).
  const cv::Mat& region() const { return region_; }

 private:
  OverlayOptions options_;
  cv::Mat region_;
  cv::Mat opacity_;  // CV_32FC1, 0..1; empty: hides nothing of the scene
  cv::Mat look_;     // CV_32FC1, grey values
  cv::Mat light_;    // CV_32FC1, factor; empty: none
};

}  // namespace floorloc
