-- SPDX-License-Identifier: Apache-2.0
-- What a server remembers beside its maps, format version 1: which version of each map is active, and the registered
-- vehicles with their poses and what they have learnt. Units: metres, radians; times are Unix seconds unless they end in _ns.
PRAGMA application_id = 0x464C5354;  -- "FLST"
PRAGMA user_version = 1;

-- The maps that have versions.
CREATE TABLE IF NOT EXISTS map (
  name          TEXT PRIMARY KEY,
  active        TEXT NOT NULL,  -- content version that is served; '': none
  previous      TEXT NOT NULL,  -- the one before it; '': none
  file_identity TEXT NOT NULL,  -- of NAME.floormap when it was last taken from the maps folder; '': never
  file_version  TEXT NOT NULL   -- its content version
) WITHOUT ROWID;

-- Map files that the server keeps: floorloc-versions/MAP/VERSION.floormap, whole and verified.
CREATE TABLE IF NOT EXISTS version (
  map             TEXT NOT NULL,
  version         TEXT NOT NULL,  -- content version
  id              TEXT NOT NULL,  -- of the map; versions with the same id have the same frame
  created         TEXT NOT NULL,  -- ISO 8601, UTC
  builder_version TEXT NOT NULL,
  parents         TEXT NOT NULL,  -- content versions that it was extended or merged from, with blanks between
  area_m2         REAL NOT NULL,
  bytes           INTEGER NOT NULL,
  added_s         REAL NOT NULL,
  origin          TEXT NOT NULL CHECK (origin IN ('upload', 'folder', 'recovered')),
  PRIMARY KEY (map, version)
) WITHOUT ROWID;

-- Registered vehicles: the body of PUT /v1/vehicles/{id}.
CREATE TABLE IF NOT EXISTS vehicle (
  id           TEXT PRIMARY KEY,
  registration TEXT NOT NULL
) WITHOUT ROWID;

-- Their last poses, map_from_base, at most a second old; none without a row.
CREATE TABLE IF NOT EXISTS pose (
  id          TEXT PRIMARY KEY,  -- vehicle.id
  map_id      TEXT NOT NULL,     -- of the map in whose frame it is; '': there is no pose, only the columns below
  stamp_ns    INTEGER NOT NULL,  -- by the vehicle's clock
  x REAL NOT NULL, y REAL NOT NULL, yaw REAL NOT NULL,
  covariance  BLOB NOT NULL,     -- float64[9], row-major, of (x, y, yaw), additive, map frame
  epoch       INTEGER NOT NULL,  -- grows with each discontinuity of the pose
  last_heard_s REAL NOT NULL,    -- of its last message, by the server's clock
  lost_reason TEXT NOT NULL      -- why a vehicle without a pose lost it; '': it had none
) WITHOUT ROWID;

-- What their messages taught about them, some seconds old at most; nothing without a row. Missing in files of early
-- servers, and made when one is opened.
CREATE TABLE IF NOT EXISTS learnt (
  id              TEXT PRIMARY KEY,  -- vehicle.id
  camera          INTEGER NOT NULL,  -- key of the registered camera with which it was learnt
  camera_in_map   INTEGER NOT NULL,  -- of that camera as the map corrected it
  learnt_values   BLOB NOT NULL,     -- float64[], the first one their format: core/tracking/learnt_values.cpp
  checksum        INTEGER NOT NULL   -- of learnt_values: first eight bytes of their SHA-256, big-endian
) WITHOUT ROWID;

-- How many images were found in the version of a map that is asked, since when. This table and the next one are missing
-- in files of early servers, and made when one is opened.
CREATE TABLE IF NOT EXISTS success (
  map      TEXT PRIMARY KEY,  -- name
  version  TEXT NOT NULL,     -- content version that the images were sought in
  square_m REAL NOT NULL,     -- side of a square
  since_s  REAL NOT NULL,     -- of the first image
  unplaced INTEGER NOT NULL   -- images that were not found, and nobody knows where they were taken
) WITHOUT ROWID;

-- The same by square of the floor, some seconds old at most; older images count less.
CREATE TABLE IF NOT EXISTS success_square (
  map     TEXT NOT NULL,
  x INTEGER NOT NULL, y INTEGER NOT NULL,  -- lower left corner, in squares from the map's (0, 0)
  found   INTEGER NOT NULL,
  missed  INTEGER NOT NULL,
  inliers INTEGER NOT NULL,                -- sum over those that were found
  PRIMARY KEY (map, x, y)
) WITHOUT ROWID;
