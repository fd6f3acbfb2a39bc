// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/features/features.h"

namespace floorloc {

/// A map version from which another one was derived.
struct MapParent {
  std::string relation;  ///< "extends" or "merges"
  std::string id;
  std::string content_version;
};

/// A part of a map file that has a version of its own: tables that a program reads together, or not at all.
struct MapFileLayer {
  std::string name;
  int version = 1;
  bool required = true;      ///< a program that does not know it must not use the map
  std::string content_hash;  ///< SHA-256, hex; empty in maps of format version 2
  bool known = true;         ///< false: this program does not read it
};

/// Where the images of a survey's camera show no floor, but what moves with the camera.
struct MapCameraMask {
  cv::Mat raw;                        ///< CV_8UC1 of the camera's size, 0 there and 255 elsewhere; empty: nowhere
  bool found = false;                 ///< by the builder; else it was given with the survey
  std::vector<std::uint8_t> picture;  ///< JPEG of an image of the camera with the mask; may be empty
};

/// What the blocks of a survey's floor look like, by the features of BlockTexture.
struct MapFloorTexture {
  static constexpr int kSize = 5;
  using Mean = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  int blocks = 0;  ///< of which it was made; 0: nothing is known
  Mean mean = Mean::Zero();
  Covariance covariance = Covariance::Identity();
};

/// A part of the floor that repeats itself on a lattice, as tiles do.
struct MapLattice {
  RectM extent;                                         ///< of the part, map frame
  double floor_share = 1.0;                             ///< share of the map's floor that lies in it
  Eigen::Matrix2d basis = Eigen::Matrix2d::Identity();  ///< columns: its two shortest vectors, metres, map frame
  /// The place in the map of the point that repeats itself most, near the middle of the part: all its copies are at
  /// this plus whole multiples of the basis.
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();
  double residual_m = 0.0;  ///< RMS distance of copies to their places on the lattice
  double share = 0.0;       ///< share of the copies within the part that lie on it
};

/// Metadata of a map; written once, when the map is built.
struct MapInfo {
  int format_version = 0;
  std::string builder_version;
  std::string id;               ///< UUID of the map; stays the same over its versions
  std::string content_version;  ///< SHA-256 of the content, hex
  std::string name;
  std::string created;        ///< ISO 8601, UTC
  double resolution_m = 0.0;  ///< of the mosaic's finest level
  RectM extent;               ///< of the surveyed floor, map frame
  double area_m2 = 0.0;       ///< surveyed floor
  ExtractorOptions extractor;
  std::vector<FloorCamera> cameras;  ///< one per survey, at least one; corrected by self-calibration
  /// One per survey: its camera as the survey had it, before the images corrected it. Empty: the file does not tell.
  std::vector<FloorCamera> given_cameras;
  /// One per survey; or empty: no camera has a mask.
  std::vector<MapCameraMask> masks;
  /// One per survey; or empty: the file does not tell.
  std::vector<MapFloorTexture> floor_textures;
  /// Where the floor repeats itself, the largest part first. Empty: nowhere, or the file does not tell.
  std::vector<MapLattice> lattices;
  std::vector<MapParent> parents;
  std::vector<MapFileLayer> layers;  ///< as the file has them, also those that this program does not know
  std::string surveys_json;          ///< provenance: one object per survey
  std::string report_json;           ///< build report

  /// Camera of the first survey: frames are rectified at its resolution.
  const FloorCamera& camera() const { return cameras.front(); }
};

/// One survey frame with its pose in the map.
struct MapFrame {
  std::int64_t stamp_ns = 0;
  std::string filename;
  Pose2 map_from_base;
  int survey = 0;                                      ///< index into MapInfo::cameras
  double gain = 1.0;                                   ///< exposure compensation: factor on the grey levels
  std::optional<Pose2> odom_from_base = std::nullopt;  ///< pose by the odometry of its survey
};

/// A motion between two frames of a map, measured by registering their images.
struct MapLink {
  int first = 0;  ///< indices of the frames
  int second = 0;
  Pose2 first_from_second;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, yaw), additive in the first's frame
  int inliers = 0;
  double rms_m = 0.0;           ///< keypoint residual
  double residual_sigma = 0.0;  ///< residual of the frames' poses, in standard deviations of the link
};

/// All keypoints of a map, in memory.
struct MapKeypoints {
  std::vector<Keypoint> keypoints;
  std::vector<std::uint16_t> observations;  ///< number of frames that saw the point
  cv::Mat descriptors;                      ///< CV_8U or CV_32F; row i describes keypoints[i]
  /// The same keypoints at the map's own heading, by DescribeUpright() of the mosaic, CV_8U; empty: the map has none.
  cv::Mat upright;
  /// Distance to the nearest descriptor at another place in the map: 0 when it is equal, 255 when it is as far as
  /// expected of a random one.
  std::vector<std::uint8_t> distinctiveness;
  std::vector<std::uint16_t> last_survey;  ///< index of the newest survey that saw the point
  /// Metres in the map frame. Positions of the keypoints are relative to it, since they are float32: far from (0, 0),
  /// as with UTM coordinates, they would be off by decimetres.
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();

  std::size_t size() const { return keypoints.size(); }
  Pose2 MapFromOrigin() const { return {origin_m.x(), origin_m.y(), 0.0}; }
  Eigen::Vector2d PositionInMap(std::size_t i) const { return origin_m + keypoints[i].Position(); }
};

/// Origin for the keypoints of a map of this extent: its centre in whole kilometres. So positions are stored in steps
/// of less than 0.1 mm in maps of up to 2 km, and maps near (0, 0) have their origin there.
Eigen::Vector2d KeypointOrigin(const RectM& extent);

/// Pyramid of the mosaic: level `max_zoom` has resolution_m, each level z - 1 twice as many metres per pixel as level
/// z. Tile (z, x, y): counted from the map frame's origin, x to the right (+x), y UP (+y); both may be negative.
struct MosaicLayout {
  int tile_px = 256;
  int max_zoom = 0;
  double resolution_m = 0.0;  ///< at max_zoom

  double TileSide(int zoom) const { return tile_px * resolution_m * static_cast<double>(1 << (max_zoom - zoom)); }
};

struct TileId {
  int z = 0;
  int x = 0;
  int y = 0;
  auto operator<=>(const TileId&) const = default;
};

struct MosaicTile {
  TileId id;
  std::vector<std::uint8_t> jpeg;  ///< encoded
};

/// A map in memory, without its mosaic.
struct FloorMap {
  MapInfo info;
  MosaicLayout mosaic;
  MapKeypoints keypoints;
};

}  // namespace floorloc
