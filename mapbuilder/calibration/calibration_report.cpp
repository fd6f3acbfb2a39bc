// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/calibration_report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

namespace floorloc {
namespace {

using nlohmann::ordered_json;

double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

ordered_json SigmasToJson(const CameraCalibration& camera) {
  ordered_json distortion = ordered_json::array();
  for (std::size_t i = 0; i < camera.camera.distortion.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i) + kFirstCoefficient;
    distortion.push_back(std::sqrt((*camera.covariance)(k, k)));
  }
  return {{"fx", camera.SigmaPx(0)},
          {"fy", camera.SigmaPx(1)},
          {"cx", camera.SigmaPx(2)},
          {"cy", camera.SigmaPx(3)},
          {"distortion", distortion}};
}

ordered_json CameraToJson(const CameraCalibration& calibration) {
  const CameraModel& camera = calibration.camera;
  ordered_json json = {{"image_width", camera.width_px},
                       {"image_height", camera.height_px},
                       {"distortion_model", ToString(camera.distortion_model)},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy},
                       {"distortion", camera.distortion},
                       {"calibration_sigma", camera.sigma_px}};
  if (calibration.covariance) {
    json["standard_deviations"] = SigmasToJson(calibration);
  }
  return json;
}

// One entry per image, in file order.
ordered_json ImagesToJson(const CalibrationResult& result) {
  ordered_json images = ordered_json::array();
  auto fit = result.camera.views.begin();
  for (const CalibrationImage& image : result.images.images) {
    ordered_json entry = {{"file", image.file.filename().string()}};
    if (!image.view) {
      entry["used"] = false;
      entry["problem"] = image.problem;
    } else {
      entry["used"] = fit->used;
      if (!fit->used) {
        entry["problem"] = "disagrees with the other images";
      }
      entry["corners"] = image.view->corners.size();
      entry["rms_px"] = fit->rms_px;
      entry["max_px"] = fit->max_px;
      entry["tilt_deg"] = Degrees(std::acos(std::min(1.0, std::abs(fit->camera_from_board.linear()(2, 2)))));
      entry["distance_m"] = fit->camera_from_board.translation().norm();
      ++fit;
    }
    images.push_back(std::move(entry));
  }
  return images;
}

ordered_json FloorToJson(const FloorCalibration& floor, const FloorPlane& plane) {
  const Eigen::Vector3d center = floor.base_from_camera.translation();
  ordered_json fits = ordered_json::array();
  for (const FloorFit& fit : floor.fits) {
    fits.push_back({{"file", fit.name}, {"rms_px", fit.rms_px}, {"rms_m", fit.rms_m}, {"max_m", fit.max_m}});
  }
  const RectM& roi = plane.roi;
  return {{"camera_position_m", {center.x(), center.y(), center.z()}},
          {"pitch_down_deg", Degrees(floor.PitchDownRad())},
          {"roi", {{"x_min", roi.x_min}, {"x_max", roi.x_max}, {"y_min", roi.y_min}, {"y_max", roi.y_max}}},
          {"resolution", plane.resolution_m},
          {"pictures", fits}};
}

void WriteCamera(const CameraCalibration& calibration, std::ostream& out) {
  const CameraModel& camera = calibration.camera;
  out << std::fixed << std::setprecision(2);
  out << "camera: " << camera.width_px << "x" << camera.height_px << ", " << ToString(camera.distortion_model);
  if (!calibration.covariance) {
    out << "; fx " << camera.fx << ", fy " << camera.fy << ", cx " << camera.cx << ", cy " << camera.cy << " px\n";
  } else {
    out << "; fx " << camera.fx << " +- " << calibration.SigmaPx(0) << ", fy " << camera.fy << " +- "
        << calibration.SigmaPx(1) << ", cx " << camera.cx << " +- " << calibration.SigmaPx(2) << ", cy " << camera.cy
        << " +- " << calibration.SigmaPx(3) << " px\n";
  }
  out << std::setprecision(3) << "images: " << calibration.used_count() << " used, reprojection error "
      << calibration.rms_px << " px (RMS)";
  if (camera.sigma_px > 0.0) {  // 0: a camera that was calibrated elsewhere does not say
    out << ", calibration good to " << camera.sigma_px << " px";
  }
  out << "\n";
}

void WriteExcluded(const CalibrationResult& result, std::ostream& out) {
  auto fit = result.camera.views.begin();
  for (const CalibrationImage& image : result.images.images) {
    const std::string name = image.file.filename().string();
    if (!image.view) {
      out << "left out: " << name << ": " << image.problem << "\n";
      continue;
    }
    if (!fit->used) {
      out << "left out: " << name << ": disagrees with the other images (" << fit->rms_px
          << " px): blurred, board bent, or another board\n";
    }
    ++fit;
  }
}

void WriteFloor(const FloorCalibration& floor, const FloorPlane& plane, std::ostream& out) {
  const Eigen::Vector3d center = floor.base_from_camera.translation();
  out << "floor: camera at x " << center.x() << ", y " << center.y() << " m, " << center.z()
      << " m high, tilted down by " << std::setprecision(1) << Degrees(floor.PitchDownRad()) << " degrees; roi x "
      << std::setprecision(3) << plane.roi.x_min << " to " << plane.roi.x_max << ", y " << plane.roi.y_min << " to "
      << plane.roi.y_max << " m, " << std::setprecision(2) << 1e3 * plane.resolution_m << " mm per pixel\n";
  for (const FloorFit& fit : floor.fits) {
    out << "floor image " << fit.name << ": " << std::setprecision(3) << fit.rms_px << " px, " << 1e3 * fit.rms_m
        << " mm (RMS)\n";
  }
}

}  // namespace

std::string ToJson(const CalibrateOptions& options, const CalibrationResult& result) {
  ordered_json json = {{"camera", CameraToJson(result.camera)},
                       {"rms_px", result.camera.rms_px},
                       {"pictures_used", result.camera.used_count()},
                       {"pictures", ImagesToJson(result)}};
  ordered_json warnings = ordered_json::array();
  for (const Diagnostic& warning : result.warnings) {
    warnings.push_back(warning.sentence);
  }
  json["warnings"] = std::move(warnings);
  json["board"] = {{"columns", options.board.columns},
                   {"rows", options.board.rows},
                   {"square_m", options.board.square_m},
                   {"thickness_m", options.board_thickness_m}};
  if (result.floor && result.plane) {
    json["floor"] = FloorToJson(*result.floor, *result.plane);
  }
  return json.dump(2);
}

std::string ToText(const CalibrationResult& result) {
  std::ostringstream out;
  WriteCamera(result.camera, out);
  WriteExcluded(result, out);
  if (result.floor && result.plane) {
    WriteFloor(*result.floor, *result.plane, out);
  } else {
    out << "floor.yaml is not written: it takes --floor-image, an image of the board on the floor, and its "
           "--board-pose\n";
  }
  return out.str();
}

}  // namespace floorloc
