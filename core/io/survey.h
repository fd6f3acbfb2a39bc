// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/io/trajectory.h"

namespace floorloc {

struct SurveyFrame {
  std::int64_t stamp_ns = 0;  ///< of the middle row (Readout::StampShiftNs)
  std::string filename;       ///< relative to the folder, with slashes
};

/// One row of imu.csv (EuRoC): angular velocity rad/s and acceleration m/s^2 in the IMU frame.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// One row of control_points.csv or gcp_list.txt: a raw pixel of a frame and its surveyed position in the map.
struct ControlPoint {
  std::string filename;
  Eigen::Vector2d raw_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d point_in_map_m = Eigen::Vector2d::Zero();
  bool of_marker = false;  ///< no row of the file: a detected marker's
  /// Standard deviation of each coordinate of the position; empty: the file does not say.
  std::optional<double> sigma_m = {};
};

/// One row of known_distances.csv: raw pixels in two frames (or one) and the measured distance of their floor points.
struct KnownDistance {
  std::string first_filename;
  Eigen::Vector2d first_raw_px = Eigen::Vector2d::Zero();
  std::string second_filename;
  Eigen::Vector2d second_raw_px = Eigen::Vector2d::Zero();
  double distance_m = 0.0;
};

/// Policy for unusable rows of frames.csv: unordered or repeated time stamps, missing images.
enum class BadFramePolicy {
  kThrow,  ///< InputError names the first one
  kSkip,   ///< rows are sorted by time; unusable ones are listed in Survey::skipped_frames
};

/// A row of frames.csv that is not used.
struct SkippedFrame {
  std::string filename;
  std::string reason;
};

/// One row of a marker file: an ArUco or AprilTag marker on the floor and its pose in the map.
struct KnownMarker {
  int id = 0;
  Eigen::Vector2d center_in_map_m = Eigen::Vector2d::Zero();
  std::optional<double> yaw_rad;  ///< of its x axis, which points right in its upright image; empty: not measured
  int line = 0;                   ///< of the file
};

/// A survey folder, parsed and checked; images must exist but are not read.
struct Survey {
  std::filesystem::path folder;
  FloorCamera camera;
  std::vector<SurveyFrame> frames;  ///< strictly increasing in time
  std::vector<SkippedFrame> skipped_frames;
  int rows_out_of_order = 0;  ///< rows of frames.csv that are earlier than the one before
  Trajectory odometry;        ///< odom_from_base; empty when the folder has none
  Trajectory ground_truth;    ///< map_from_base; empty when the folder has none
  std::vector<ImuSample> imu;
  std::vector<ControlPoint> control_points;
  std::filesystem::path control_point_file;  ///< that they were read from; empty: none
  std::vector<KnownDistance> known_distances;
  cv::Mat mask;  ///< mask.png: CV_8UC1 of the camera's size, 0 where images show no floor (the robot's body); or empty

  std::filesystem::path ImagePath(const SurveyFrame& frame) const { return folder / frame.filename; }
};

/// Last component of the folder's path, also of one that ends with a slash or is ".".
std::string FolderName(const std::filesystem::path& folder);

/// Reads a folder in the survey format. Without frames.csv the frames are the files of images/ in alphabetical order,
/// one second apart. Throws InputError that names file, line and reason.
Survey ReadSurvey(const std::filesystem::path& folder, BadFramePolicy bad_frames = BadFramePolicy::kThrow);

/// Images of a calibrated camera that need not show a floor: a survey folder, of which floor.yaml is not required.
struct CameraRecording {
  std::filesystem::path folder;
  CameraModel camera;
  std::vector<SurveyFrame> frames;  ///< strictly increasing in time

  std::filesystem::path ImagePath(const SurveyFrame& frame) const { return folder / frame.filename; }
};

/// Throws InputError that names file, line and reason.
CameraRecording ReadCameraRecording(const std::filesystem::path& folder);

/// Parses the rows in the order of the file. Fields may stand in double quotes, and file names may have backslashes, as
/// tools on Windows write both. kSkip: time stamps need not increase.
std::vector<SurveyFrame> ParseFramesCsv(const std::string& text, const std::filesystem::path& source,
                                        BadFramePolicy bad_frames = BadFramePolicy::kThrow);
std::vector<ImuSample> ParseImuCsv(const std::string& text, const std::filesystem::path& source);
std::string FormatImuCsv(const std::vector<ImuSample>& samples);
/// "filename,u,v,x,y" or "filename,u,v,x,y,sigma": metres in the map frame; a sigma may be empty.
std::vector<ControlPoint> ParseControlPointsCsv(const std::string& text, const std::filesystem::path& source);
/// OpenDroneMap's gcp_list.txt: a line with the projection (a plane one: UTM, EPSG:..., +proj=...), then rows of
/// "geo_x geo_y geo_z im_x im_y image_name [gcp_name] [extra fields]". Heights are not used; the map's axes are the
/// projection's. Image names are those of the file; ReadSurvey finds the frames.
std::vector<ControlPoint> ParseGcpList(const std::string& text, const std::filesystem::path& source);
std::vector<KnownDistance> ParseKnownDistancesCsv(const std::string& text, const std::filesystem::path& source);
/// "id,x,y,yaw": metres and radians in the map frame; yaw may be empty. Ids must be unique.
std::vector<KnownMarker> ParseMarkersCsv(const std::string& text, const std::filesystem::path& source);

}  // namespace floorloc
