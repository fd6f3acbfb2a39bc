// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/map/content_hash.h"
#include "core/map/floor_map.h"
#include "core/map/sqlite.h"

namespace floorloc {

// Constants and encodings shared by reader and writer.
constexpr std::int64_t kMapApplicationId = 0x464C4F43;  // "FLOC"
constexpr int kMapFormatVersion = 3;                    // version that is written
constexpr int kOldestMapFormatVersion = 2;
constexpr int kFirstVersionWithLayers = 3;
/// Largest coordinate in the map frame; allows UTM coordinates, whose northings end at 10,000 km.
constexpr double kMaxMapCoordinateM = 1e7;

Blob PackDoubles(std::span<const double> values);
/// Empty when the length is not a multiple of 8.
std::vector<double> UnpackDoubles(const Blob& blob);

int ReadFormatVersion(const SqliteConnection& connection);

/// True for 64 hex digits in lower case.
bool IsSha256(const std::string& text);

/// Adds all rows of a query, each value with its type: schema/README.md has the layout.
void AddRows(const SqliteConnection& connection, const std::string& query, ContentHash* hash);

/// SHA-256 over the content of a map; layers enter by their hashes in the table of layers. schema/README.md lists what
/// is excluded. Format version 2: over what affects the answers only (frame placement, links, cameras, extractor,
/// keypoints, mosaic).
std::string ComputeContentVersion(const SqliteConnection& connection);

}  // namespace floorloc
