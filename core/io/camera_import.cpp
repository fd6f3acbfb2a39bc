// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_import.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/io/camera_yaml.h"
#include "core/io/imported_lens.h"
#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr char kKalibr[] = "a camchain of Kalibr";
constexpr char kFileStorage[] = "a file of OpenCV's FileStorage";
constexpr char kCameraInfo[] = "a ROS camera_info message";
constexpr char kOtherNames[] = "a camera matrix under other names";

// The camera's number may follow: M1, cameraMatrix1.
constexpr Names kMatrixNames = {"cameramatrix", "cameramat", "intrinsicmatrix", "mtx", "k", "m"};
constexpr Names kDistortionNames = {
    "distortioncoefficients", "distortioncoeffs", "distcoeffs", "distcoeff", "dist", "d"};
constexpr Names kProjectionNames = {"projectionmatrix", "p"};

// The cameras of a camchain: cam0, cam1, ...; or the whole file, as EuRoC's sensor.yaml.
std::vector<YamlEntry> ChainCameras(const YamlDocument& document) {
  if (document.Has("intrinsics") && document.Has("resolution")) {
    return {{"", document.root()}};
  }
  std::vector<YamlEntry> cameras;
  for (const auto& entry : document.root()) {
    if (entry.first.IsScalar() && entry.second.IsMap() && entry.second["intrinsics"].IsDefined()) {
      cameras.push_back({entry.first.Scalar(), entry.second});
    }
  }
  return cameras;
}

bool HasOpenCvTag(const YamlDocument& document) {
  return std::any_of(document.root().begin(), document.root().end(), [](const auto& entry) {
    return entry.second.IsMap() && entry.second.Tag() == "tag:yaml.org,2002:opencv-matrix";
  });
}

const YamlEntry& ChooseCamera(const YamlDocument& document, const std::vector<YamlEntry>& cameras,
                              const std::string& name) {
  std::string known;
  for (const YamlEntry& camera : cameras) {
    if (camera.key == name || (name.empty() && cameras.size() == 1)) {
      return camera;
    }
    known += (known.empty() ? "" : ", ") + camera.key;
  }
  throw InputError(document.source(), name.empty() ? "holds several cameras; choose one of " + known + " with --camera"
                                                   : "has no camera '" + name + "'; --camera may be " + known);
}

CameraModel FromCamchain(const YamlDocument& document, const YamlEntry& chosen, const CameraImportOptions& options) {
  const YAML::Node& node = chosen.value;
  if (const auto model = FindKey(node, "camera_model");
      model && document.Text(model->value, "camera_model") != "pinhole") {
    document.Fail(model->value.Mark(), "camera_model '" + model->value.Scalar() +
                                           "' cannot be used; calibrate again with Kalibr's --models pinhole-radtan or "
                                           "pinhole-equi");
  }
  const std::vector<double> k = MatrixNumbers(document, {"intrinsics", document.Get(node, "intrinsics")}, 4);
  const YAML::Node size = document.Get(node, "resolution");
  if (!size.IsSequence() || size.size() != 2) {
    document.Fail(size.Mark(), "resolution must be [width, height]; correct it");
  }
  CameraModel camera;
  camera.name = chosen.key;
  camera.width_px = document.Pixels(size[0], "resolution");
  camera.height_px = document.Pixels(size[1], "resolution");
  camera.fx = k[0];
  camera.fy = k[1];
  camera.cx = k[2];
  camera.cy = k[3];
  auto coefficients = FindKey(node, "distortion_coeffs");
  coefficients = coefficients ? coefficients : FindKey(node, "distortion_coefficients");
  ReadLens(document, {FindKey(node, "distortion_model"), coefficients, options.model}, &camera);
  return camera;
}

// camera_info: K is that of the whole sensor, whatever part of it the images show.
void RefuseBinning(const YamlDocument& document) {
  for (const char* key : {"binning_x", "binning_y"}) {
    if (const auto binning = FindKey(document.root(), key); binning && document.Number(binning->value, key) > 1.0) {
      document.Fail(binning->value.Mark(), std::string(key) +
                                               ": the images are binned, and K is that of the whole sensor; take a "
                                               "message without binning, and images of that size");
    }
  }
  const auto roi = FindKey(document.root(), "roi");
  for (const char* key : {"x_offset", "y_offset"}) {
    if (const auto offset = roi && roi->value.IsMap() ? FindKey(roi->value, key) : std::nullopt;
        offset && document.Number(offset->value, key) != 0.0) {
      document.Fail(offset->value.Mark(), std::string("roi.") + key +
                                              ": the images show a part of the sensor, and K is that of the whole; "
                                              "take a message of the whole sensor");
    }
  }
}

void SetSize(const YamlDocument& document, const CameraImportOptions& options, CameraModel* camera) {
  const auto width = FindByName(document, {"imagewidth", "width"});
  const auto height = FindByName(document, {"imageheight", "height"});
  const auto both = FindByName(document, {"imagesize", "resolution", "size"});
  if (width && height) {
    camera->width_px = document.Pixels(width->value, width->key);
    camera->height_px = document.Pixels(height->value, height->key);
  } else if (both && both->value.IsSequence() && both->value.size() == 2) {
    camera->width_px = document.Pixels(both->value[0], both->key);
    camera->height_px = document.Pixels(both->value[1], both->key);
  } else if (options.size_px) {
    camera->width_px = (*options.size_px)[0];
    camera->height_px = (*options.size_px)[1];
  } else {
    throw InputError(document.source(),
                     "does not say how large the images are; add --size WIDTHxHEIGHT, that of the "
                     "images of the calibration");
  }
}

YamlEntry RequireMatrix(const YamlDocument& document, Names names, const std::string& what, const std::string& camera) {
  if (const auto entry = FindByName(document, names, camera)) {
    return *entry;
  }
  const bool several = camera.empty() && FindByName(document, names, "1");
  throw InputError(document.source(), "holds no " + what +
                                          (several ? ", but those of several cameras; choose one with --camera 1"
                                                   : "; check that it is a calibration of one camera"));
}

CameraModel FromMatrices(const YamlDocument& document, const CameraImportOptions& options) {
  CameraModel camera;
  SetSize(document, options, &camera);
  RefuseBinning(document);
  const Names names = options.rectified ? kProjectionNames : kMatrixNames;
  const std::size_t columns = options.rectified ? 4 : 3;
  const YamlEntry matrix =
      RequireMatrix(document, names, options.rectified ? "projection matrix P" : "camera matrix", options.camera);
  const std::vector<double> k = MatrixNumbers(document, matrix, 3 * columns);
  if (k[0] == 0.0) {
    document.Fail(matrix.value.Mark(), matrix.key + " is all zeros: the camera was not calibrated; calibrate it");
  }
  if (k[1] != 0.0 || k[columns] != 0.0) {
    document.Fail(matrix.value.Mark(), matrix.key + " has skew, which cannot be used; calibrate again without it");
  }
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[columns + 1];
  camera.cy = k[columns + 2];
  if (options.rectified) {
    camera.distortion.assign(5, 0.0);
  } else {
    const YamlEntry numbers = RequireMatrix(document, kDistortionNames, "distortion coefficients", options.camera);
    ReadLens(document, {FindKey(document.root(), "distortion_model"), numbers, options.model}, &camera);
  }
  if (const auto name = FindKey(document.root(), "camera_name")) {
    camera.name = document.Text(name->value, name->key);
  }
  return camera;
}

ImportedCamera FromDocument(const YamlDocument& document, const CameraImportOptions& options) {
  ImportedCamera imported;
  imported.format = OtherCameraFormat(document);
  imported.camera =
      imported.format == kKalibr
          ? FromCamchain(document, ChooseCamera(document, ChainCameras(document), options.camera), options)
          : FromMatrices(document, options);
  if (imported.format.empty()) {
    imported.format = "camera.yaml";
  }
  if (!options.name.empty()) {
    imported.camera.name = options.name;
  }
  imported.camera.Check();
  return imported;
}

}  // namespace

void CameraImportOptions::Check() const {
  RequireOption(!size_px || ((*size_px)[0] > 0 && (*size_px)[1] > 0), "size_px must be positive numbers of pixels");
}

std::string OtherCameraFormat(const YamlDocument& document) {
  if (!ChainCameras(document).empty()) {
    return kKalibr;
  }
  if (HasOpenCvTag(document)) {
    return document.Has("distortion_model") && document.Has("camera_matrix") ? "" : kFileStorage;
  }
  const bool other_matrix = !document.Has("camera_matrix") && FindByName(document, kMatrixNames);
  const bool other_distortion = !document.Has("distortion_coefficients") && FindByName(document, kDistortionNames);
  if (other_matrix && other_distortion && FindByName(document, {"height"})) {
    return kCameraInfo;
  }
  const bool numbered = FindByName(document, kMatrixNames, "1") && FindByName(document, kDistortionNames, "1");
  return other_matrix || other_distortion || numbered ? kOtherNames : "";
}

ImportedCamera ImportCamera(const std::string& text, const std::filesystem::path& source,
                            const CameraImportOptions& options) {
  options.Check();
  const YamlDocument document(text, source);
  try {
    return FromDocument(document, options);
  } catch (const YAML::Exception& error) {
    document.Fail(error.mark, "has an unexpected structure (" + error.msg + "); correct the line");
  } catch (const std::invalid_argument& error) {
    throw InputError(source, std::string(error.what()) + "; correct it");
  }
}

}  // namespace floorloc
