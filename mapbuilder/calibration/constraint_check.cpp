// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/constraint_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace floorloc {
namespace {

constexpr int kFewImages = 8;

// Angles between the boards: without tilt, focal length and distance are not separable.
constexpr double kNoTiltDeg = 4.0;
constexpr double kLittleTiltDeg = 20.0;

// Farthest corner, relative to the distance from the image centre to its corner.
constexpr double kOnlyMiddle = 0.45;
constexpr double kNotOutside = 0.8;

// Standard deviations relative to the focal length and to the image width.
constexpr double kOpenSigma = 0.01;
constexpr double kWeakSigma = 0.002;

constexpr double kOneDistance = 1.15;
constexpr double kPoorFitPx = 1.0;
constexpr double kNoFitPx = 4.0;

std::string Text(const char* format, double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

template <typename Visit>
void ForEachUsed(const CameraCalibrationInput& input, const CameraCalibration& calibration, Visit visit) {
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    if (calibration.views[i].used) {
      visit(input.views[i].view, calibration.views[i]);
    }
  }
}

class Checker {
 public:
  Checker(const CameraCalibrationInput& input, const CameraCalibration& calibration)
      : input_(input), calibration_(calibration) {}

  std::vector<Diagnostic> Run() {
    CheckFit();
    CheckTilt();
    CheckCoverage();
    CheckDeviations();
    CheckCount();
    return std::move(diagnostics_);
  }

 private:
  void AddDiagnostic(bool fatal, const std::string& sentence) { diagnostics_.push_back({fatal, sentence}); }

  void CheckFit() {
    if (calibration_.rms_px > kPoorFitPx) {
      AddDiagnostic(
          calibration_.rms_px > kNoFitPx,
          "the images fit the camera badly (" + Text("%.2f", calibration_.rms_px) +
              " px): check that the board is flat and --board right, that zoom and focus stayed as they were, or "
              "try another --model");
    }
  }

  void CheckTilt() {
    std::vector<Eigen::Vector3d> normals;
    ForEachUsed(input_, calibration_, [&](const BoardView&, const ViewFit& fit) {
      normals.emplace_back(fit.camera_from_board.linear().col(2));
    });
    double smallest_cos = 1.0;
    for (const Eigen::Vector3d& a : normals) {
      for (const Eigen::Vector3d& b : normals) {
        smallest_cos = std::min(smallest_cos, a.dot(b));
      }
    }
    const double spread_deg = std::acos(std::max(-1.0, smallest_cos)) * 180.0 / std::numbers::pi;
    if (spread_deg < kLittleTiltDeg) {
      no_tilt_ = spread_deg < kNoTiltDeg;
      AddDiagnostic(no_tilt_, "the boards are tilted by no more than " + Text("%.0f", spread_deg) +
                                  " degrees against each other, so focal length and distance are hardly separable: add "
                                  "images with the board tilted by 20 to 45 degrees to each of its four sides");
    }
  }

  void CheckCoverage() {
    const double half_diagonal = 0.5 * std::hypot(input_.width_px, input_.height_px);
    const double share = CalibratedRadiusPx(input_, calibration_) / half_diagonal;
    if (share < kOnlyMiddle) {
      AddDiagnostic(true,
                    "the board was only seen in the middle of the image (up to " + Text("%.0f", 100.0 * share) +
                        " % of the way to its corners), which leaves the lens outside of it open: add images with "
                        "the board at every edge and in every corner of the image");
      return;
    }
    const std::string missing = MissingRegions();
    if (!missing.empty()) {
      AddDiagnostic(false, "no image shows the board in " + missing + " of the image: add images with the board there");
    } else if (share < kNotOutside) {
      AddDiagnostic(false, "the corners of the image were never reached (" + Text("%.0f", 100.0 * share) +
                               " % of the way): add images with the board in the corners");
    }
  }

  // Thirds of the image without any board corner, e.g. "the upper left, the right".
  std::string MissingRegions() const {
    constexpr std::array kNames{"the upper left", "the upper middle", "the upper right",
                                "the left",       "the middle",       "the right",
                                "the lower left", "the lower middle", "the lower right"};
    std::array<bool, 9> covered{};
    ForEachUsed(input_, calibration_, [&](const BoardView& view, const ViewFit&) {
      for (const Eigen::Vector2d& p : view.raw_px) {
        const int column = std::clamp(static_cast<int>(3.0 * p.x() / input_.width_px), 0, 2);
        const int row = std::clamp(static_cast<int>(3.0 * p.y() / input_.height_px), 0, 2);
        const int third = 3 * row + column;
        covered[static_cast<std::size_t>(third)] = true;
      }
    });
    std::string missing;
    for (std::size_t i = 0; i < covered.size(); ++i) {
      missing += covered[i] ? "" : (missing.empty() ? "" : ", ") + std::string(kNames[i]);
    }
    return missing;
  }

  void CheckDeviations() {
    const CameraModel& camera = calibration_.camera;
    const double focal = std::max(calibration_.SigmaPx(0) / camera.fx, calibration_.SigmaPx(1) / camera.fy);
    const double center = std::max(calibration_.SigmaPx(2), calibration_.SigmaPx(3)) / camera.width_px;
    if (focal > kWeakSigma && !no_tilt_) {
      AddDiagnostic(focal > kOpenSigma,
                    "the focal length is only known to " + Text("%.2g", 100.0 * focal) + " %: " +
                        (HasOneDistance() ? "all boards are equally far away; add images from nearer "
                                            "and from farther away, some with the board tilted"
                                          : "add images with the board tilted by 20 to 45 degrees"));
    }
    if (center > kWeakSigma && !no_tilt_) {
      AddDiagnostic(center > kOpenSigma,
                    "the principal point is only known to " + Text("%.2g", center * camera.width_px) +
                        " px: add images with the board tilted to other sides and turned by 90 degrees");
    }
  }

  bool HasOneDistance() const {
    double nearest = std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    ForEachUsed(input_, calibration_, [&](const BoardView&, const ViewFit& fit) {
      nearest = std::min(nearest, fit.camera_from_board.translation().norm());
      farthest = std::max(farthest, fit.camera_from_board.translation().norm());
    });
    return farthest < kOneDistance * nearest;
  }

  void CheckCount() {
    if (calibration_.used_count() < kFewImages) {
      AddDiagnostic(false, "only " + std::to_string(calibration_.used_count()) +
                               " images show the board: with 10 to 20 from different sides a bad one is recognized");
    }
  }

  const CameraCalibrationInput& input_;
  const CameraCalibration& calibration_;
  bool no_tilt_ = false;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace

std::vector<Diagnostic> CheckConstraints(const CameraCalibrationInput& input, const CameraCalibration& calibration) {
  return Checker(input, calibration).Run();
}

double CalibratedRadiusPx(const CameraCalibrationInput& input, const CameraCalibration& calibration) {
  const Eigen::Vector2d principal(calibration.camera.cx, calibration.camera.cy);
  double radius = 0.0;
  ForEachUsed(input, calibration, [&](const BoardView& view, const ViewFit&) {
    for (const Eigen::Vector2d& p : view.raw_px) {
      radius = std::max(radius, (p - principal).norm());
    }
  });
  return radius;
}

}  // namespace floorloc
