-- SPDX-License-Identifier: Apache-2.0
-- A floor map, format version 3. Units: metres, radians. Frame: map (x right, y up, z = 0 on the floor).
-- Every BLOB is little-endian and packed; schema/README.md has the layouts. A checksum is the first eight bytes of the
-- SHA-256 of the row's blobs, in column order, as a big-endian signed integer.
PRAGMA application_id = 0x464C4F43;  -- "FLOC"
PRAGMA user_version = 3;

CREATE TABLE map (
  one             INTEGER PRIMARY KEY CHECK (one = 1),
  builder_version TEXT NOT NULL,
  id              TEXT NOT NULL,  -- UUID, the same for all versions of a map
  content_version TEXT NOT NULL,  -- SHA-256 over the content, hex; schema/README.md lists the columns
  name            TEXT NOT NULL,
  created         TEXT NOT NULL,  -- ISO 8601, UTC
  frame           TEXT NOT NULL,  -- 'map'
  resolution_m    REAL NOT NULL,  -- of the mosaic's finest level
  x_min REAL NOT NULL, x_max REAL NOT NULL, y_min REAL NOT NULL, y_max REAL NOT NULL,  -- surveyed floor
  area_m2         REAL NOT NULL,
  keypoint_tile_m REAL NOT NULL,  -- side of the tiles of keypoint_tile
  descriptor_type TEXT NOT NULL CHECK (descriptor_type IN ('binary', 'float')),
  descriptor_length INTEGER NOT NULL,  -- bytes (binary) or float32 elements (float)
  mosaic_tile_px  INTEGER NOT NULL,
  mosaic_max_zoom INTEGER NOT NULL,
  surveys_json    TEXT NOT NULL,  -- provenance, one object per survey
  report_json     TEXT NOT NULL   -- the builder's measurements
);

-- The layers of this file beyond its metadata. A reader refuses a map with an unknown required layer and ignores an
-- unknown optional one; schema/README.md has the policy.
CREATE TABLE layer (
  name         TEXT PRIMARY KEY,
  version      INTEGER NOT NULL,  -- of the layer's tables
  required     INTEGER NOT NULL CHECK (required IN (0, 1)),
  content_hash TEXT NOT NULL      -- SHA-256 of its content, hex; included in map.content_version
) WITHOUT ROWID;

-- Map versions that this map was extended or merged from; empty for a map built from surveys alone.
CREATE TABLE parent (
  relation        TEXT NOT NULL CHECK (relation IN ('extends', 'merges')),
  id              TEXT NOT NULL,
  content_version TEXT NOT NULL
);

-- All options of the feature extractor; a reader must use exactly these.
CREATE TABLE extractor_parameter (
  name  TEXT PRIMARY KEY,
  value NOT NULL
) WITHOUT ROWID;

-- Camera and floor plane of each survey, numbered from 0.
CREATE TABLE camera (
  survey           INTEGER PRIMARY KEY,
  name             TEXT NOT NULL,
  width_px         INTEGER NOT NULL,
  height_px        INTEGER NOT NULL,
  fx REAL NOT NULL, fy REAL NOT NULL, cx REAL NOT NULL, cy REAL NOT NULL,
  distortion_model TEXT NOT NULL,
  distortion       BLOB NOT NULL,  -- float64[n]
  homography       BLOB NOT NULL,  -- float64[9], row-major: undistorted pixel -> base
  roi_x_min REAL NOT NULL, roi_x_max REAL NOT NULL, roi_y_min REAL NOT NULL, roi_y_max REAL NOT NULL,
  resolution_m     REAL NOT NULL
);

-- What the calibration of a survey's camera is worth, and the calibration that the survey had before the images corrected
-- it: a vehicle with the same one is corrected likewise.
CREATE TABLE calibration (
  survey           INTEGER PRIMARY KEY,
  sigma_px         REAL NOT NULL,  -- standard deviation at the corners of the region of interest; 0: unknown
  offset_sigma_m   REAL NOT NULL,  -- of the base frame's place by roll and pitch; 0: unknown
  given_fx REAL NOT NULL, given_fy REAL NOT NULL, given_cx REAL NOT NULL, given_cy REAL NOT NULL,
  given_distortion BLOB NOT NULL,  -- float64[n], of the camera's distortion_model
  given_homography BLOB NOT NULL   -- float64[9]
);

-- Where the images of a survey's camera show no floor, but what moves with the camera (the robot's own body, dirt). Only
-- of the surveys that have such a mask.
CREATE TABLE camera_mask (
  survey  INTEGER PRIMARY KEY,
  found   INTEGER NOT NULL CHECK (found IN (0, 1)),  -- 1: by the builder, 0: given with the survey
  runs    BLOB NOT NULL,  -- uint32[n]: pixels of floor and of no floor by turns, row by row from the top left
  picture BLOB NOT NULL   -- JPEG of an image with the mask, to be looked at; may be empty
);

-- What the floor of a survey looks like, block by block (48 rectified pixels a side). Only of the surveys that show enough
-- of it.
CREATE TABLE floor_texture (
  survey     INTEGER PRIMARY KEY,
  blocks     INTEGER NOT NULL,  -- of which the model was made
  mean       BLOB NOT NULL,     -- float64[5]; schema/README.md names the features
  covariance BLOB NOT NULL      -- float64[15]: upper triangle, row-major
);

-- Where the floor repeats itself, as tiles do: regions, numbered from 0, the one with the most floor first. In each, the
-- floor looks alike at all whole multiples of two vectors. No rows: nowhere.
CREATE TABLE floor_lattice (
  region      INTEGER PRIMARY KEY,
  x_min REAL NOT NULL, x_max REAL NOT NULL, y_min REAL NOT NULL, y_max REAL NOT NULL,  -- rectangle that holds it
  floor_share REAL NOT NULL,                         -- share of the map's floor that lies in the region
  first_x REAL NOT NULL, first_y REAL NOT NULL,      -- the lattice's two shortest vectors
  second_x REAL NOT NULL, second_y REAL NOT NULL,
  point_x REAL NOT NULL, point_y REAL NOT NULL,      -- a place of the point that repeats itself most
  residual_m REAL NOT NULL,                          -- RMS distance of copies to their places on the lattice
  share      REAL NOT NULL                           -- share of the copies that lie on it
);

-- Survey frames with their optimised poses.
CREATE TABLE frame (
  id         INTEGER PRIMARY KEY,  -- from 0
  survey     INTEGER NOT NULL,
  stamp_ns   INTEGER NOT NULL,
  filename   TEXT NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, yaw REAL NOT NULL,  -- map_from_base
  gain       REAL NOT NULL,        -- factor that compensates its exposure
  odom_x REAL, odom_y REAL, odom_yaw REAL               -- odom_from_base of its survey; NULL without odometry
);

-- Relative poses between frames, measured by registering their images: edges of the pose graph.
CREATE TABLE link (
  first INTEGER NOT NULL, second INTEGER NOT NULL,      -- frame.id
  x REAL NOT NULL, y REAL NOT NULL, yaw REAL NOT NULL,  -- first_from_second
  covariance     BLOB NOT NULL,     -- float64[6]: upper triangle, row-major, of (x, y, yaw)
  inliers        INTEGER NOT NULL,
  rms_m          REAL NOT NULL,     -- keypoint residual
  residual_sigma REAL NOT NULL,     -- residual of the frames' poses, standard deviations
  PRIMARY KEY (first, second)
) WITHOUT ROWID;

-- Keypoints in square tiles: tile (x, y) covers [x, x+1) * keypoint_tile_m and likewise in y.
CREATE TABLE keypoint_tile (
  x INTEGER NOT NULL, y INTEGER NOT NULL,
  count        INTEGER NOT NULL,
  position     BLOB NOT NULL,  -- float32[count][2], relative to the tile's lower left corner
  angle        BLOB NOT NULL,  -- float32[count]
  size         BLOB NOT NULL,  -- float32[count]
  response     BLOB NOT NULL,  -- float32[count]
  observations BLOB NOT NULL,  -- uint16[count]
  distinctiveness BLOB NOT NULL,  -- uint8[count]
  last_survey  BLOB NOT NULL,  -- uint16[count]
  descriptor   BLOB NOT NULL,  -- uint8[count][descriptor_length] or float32[count][descriptor_length]
  checksum     INTEGER NOT NULL,
  PRIMARY KEY (x, y)
) WITHOUT ROWID;

-- The same keypoints, in the same order, described at the map's own heading: what a frame is compared with whose heading
-- is known. Only of extractors that can; then one row for each row of keypoint_tile.
CREATE TABLE keypoint_upright (
  x INTEGER NOT NULL, y INTEGER NOT NULL,
  descriptor BLOB NOT NULL,  -- uint8[keypoint_tile.count][32]
  checksum   INTEGER NOT NULL,
  PRIMARY KEY (x, y)
) WITHOUT ROWID;

-- The mosaic: level mosaic_max_zoom has resolution_m, each lower z twice the metres per pixel. Tile (z, x, y) covers
-- [x, x+1) * side by [y, y+1) * side in the map frame: y grows UP.
CREATE TABLE mosaic_tile (
  z INTEGER NOT NULL, x INTEGER NOT NULL, y INTEGER NOT NULL,
  jpeg     BLOB NOT NULL,
  checksum INTEGER NOT NULL,
  PRIMARY KEY (z, x, y)
) WITHOUT ROWID;
