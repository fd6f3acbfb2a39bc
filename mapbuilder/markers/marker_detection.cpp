// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/markers/marker_detection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/fiducials/aruco_dictionary.h"

namespace floorloc {
namespace {

using MarkerInImage = std::vector<cv::Point2f>;  // four corners

// Refines corners to sub-pixel accuracy; the window stays within the marker's black border and the surrounding white.
void Refine(const cv::Mat& smooth, int modules, MarkerInImage* corners) {
  double shortest = cv::norm((*corners)[3] - (*corners)[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    shortest = std::min(shortest, cv::norm((*corners)[i + 1] - (*corners)[i]));
  }
  const int half = std::clamp(static_cast<int>(0.7 * shortest / modules), 2, 8);
  cv::cornerSubPix(smooth, *corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-3});
}

// point_of: where a raw pixel sees the floor, base frame.
std::vector<MarkerDetection> DetectIn(const cv::Mat& raw,
                                      const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& point_of,
                                      const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  std::vector<MarkerInImage> found;
  std::vector<int> ids;
  cv::aruco::detectMarkers(raw, dictionary, found, ids);
  std::vector<MarkerDetection> detections;
  if (found.empty()) {
    return detections;
  }
  cv::Mat smooth;
  cv::GaussianBlur(raw, smooth, {}, 0.7);  // sharp edges are aliased, which biases the corners
  for (std::size_t i = 0; i < found.size(); ++i) {
    Refine(smooth, dictionary->markerSize + 2, &found[i]);
    MarkerDetection detection;
    detection.id = ids[i];
    bool on_floor = true;
    for (std::size_t c = 0; c < 4; ++c) {
      detection.corners_m[c] = point_of({found[i][c].x, found[i][c].y});
      on_floor = on_floor && detection.corners_m[c].allFinite();
    }
    if (on_floor) {
      detections.push_back(detection);
    }
  }
  return detections;
}

}  // namespace

double MarkerDetection::MeanSideM() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += (corners_m[(i + 1) % 4] - corners_m[i]).norm();
  }
  return 0.25 * sum;
}

bool MarkerDetection::IsSquare(double tolerance) const {
  const double side = MeanSideM();
  for (std::size_t i = 0; i < 4; ++i) {
    if (std::abs((corners_m[(i + 1) % 4] - corners_m[i]).norm() - side) > tolerance * side) {
      return false;
    }
  }
  // A rhombus also has equal sides.
  const double diagonals = (corners_m[2] - corners_m[0]).norm() - (corners_m[3] - corners_m[1]).norm();
  return std::abs(diagonals) < 2.0 * tolerance * side;
}

void MarkerDetectionOptions::Check() const {
  RequireOption(size_m >= 0.0, "size_m must be a positive number of metres, or 0 where no markers are sought");
  run.Check();
}

std::vector<MarkerDetection> DetectMarkers(const std::vector<BuildFrame>& frames,
                                           const std::vector<LoadedSurvey>& surveys,
                                           const MarkerDetectionOptions& options) {
  options.Check();
  const cv::Ptr<cv::aruco::Dictionary> dictionary = FindPublishedDictionary(options.dictionary);
  std::vector<std::vector<MarkerDetection>> per_frame(frames.size());
  ProgressBar progress("markers", static_cast<std::int64_t>(frames.size()), options.run.progress);
  ParallelFor(static_cast<int>(frames.size()), options.run.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const Survey& survey = surveys[static_cast<std::size_t>(frames[index].survey)].survey;
    const CameraModel& camera = survey.camera.camera;
    try {
      const cv::Mat raw = ReadGrayImage(survey.ImagePath(frames[index].info), camera.width_px, camera.height_px);
      const auto point_of = [&](const Eigen::Vector2d& raw_px) { return FloorPointOf(frames[index], surveys, raw_px); };
      per_frame[index] = DetectIn(raw, point_of, dictionary);
    } catch (const InputError&) {
      // The stage before this one has reported it.
    }
    progress.Advance();
  });
  std::vector<MarkerDetection> all;
  for (std::size_t i = 0; i < per_frame.size(); ++i) {
    for (MarkerDetection& detection : per_frame[i]) {
      detection.frame = static_cast<int>(i);
      all.push_back(detection);
    }
  }
  return all;
}

}  // namespace floorloc
