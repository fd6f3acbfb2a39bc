// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/camera_of_bag.h"

#include <algorithm>
#include <stdexcept>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

[[noreturn]] void Fail(const std::string& topic, const std::string& what) {
  throw InputError("topic " + topic + ": " + what + "; give the calibration with --camera camera.yaml");
}

struct Lens {
  DistortionModel model = DistortionModel::kPlumbBob;
  std::vector<double> coefficients = {0, 0, 0, 0};
};

// Coefficients beyond those of the model that do nothing are cut off: OpenCV gives up to 14.
Lens LensOf(const RosCameraInfo& info, const std::string& topic) {
  std::vector<double> d = info.d;
  while (!d.empty() && d.back() == 0.0) {
    d.pop_back();
  }
  const std::string& name = info.distortion_model;
  Lens lens;
  std::size_t count = 4;
  if (name == "equidistant" || name == "fisheye") {
    lens.model = DistortionModel::kEquidistant;
  } else if (d.size() > 5 && (name == "rational_polynomial" || name == "plumb_bob")) {
    lens.model = DistortionModel::kRationalPolynomial;
    count = 8;
  } else if (name == "plumb_bob" || name == "radtan" || name == "rational_polynomial" || d.empty()) {
    count = d.size() == 5 ? 5 : 4;
  } else {
    Fail(topic, "its distortion model '" + name + "' is none of plumb_bob, rational_polynomial and equidistant");
  }
  if (d.size() > count) {
    Fail(topic, "its distortion model '" + name + "' has " + std::to_string(d.size()) + " coefficients");
  }
  d.resize(count, 0.0);
  lens.coefficients = d;
  return lens;
}

}  // namespace

CameraModel CameraOfInfo(const RosCameraInfo& info, bool rectified, const std::string& name, const std::string& topic) {
  if (!(info.k[0] > 0.0)) {
    Fail(topic, "the camera is not calibrated (K is 0)");
  }
  const Lens lens = rectified ? Lens{} : LensOf(info, topic);
  CameraModel camera;
  camera.name = name;
  camera.distortion_model = lens.model;
  camera.distortion = lens.coefficients;
  const double x_step = std::max(info.binning_x, 1u);
  const double y_step = std::max(info.binning_y, 1u);
  const std::uint32_t width = info.roi_width_px > 0 ? info.roi_width_px : info.width_px;
  const std::uint32_t height = info.roi_height_px > 0 ? info.roi_height_px : info.height_px;
  constexpr std::uint32_t kMaxSidePx = 16384;  // as CameraModel::Check() has it
  if (width > kMaxSidePx || height > kMaxSidePx) {
    Fail(topic, "it tells images of " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
  }
  camera.width_px = static_cast<int>(width / x_step);
  camera.height_px = static_cast<int>(height / y_step);
  const auto pick = [&](std::size_t of_k, std::size_t of_p) { return rectified ? info.p[of_p] : info.k[of_k]; };
  camera.fx = pick(0, 0) / x_step;
  camera.fy = pick(4, 5) / y_step;
  camera.cx = (pick(2, 2) - info.roi_x_offset) / x_step;
  camera.cy = (pick(5, 6) - info.roi_y_offset) / y_step;
  try {
    camera.Check();
  } catch (const std::invalid_argument& error) {
    Fail(topic, error.what());
  }
  return camera;
}

}  // namespace floorloc
